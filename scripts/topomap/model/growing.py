"""Sequences that grow at their end: one that is longer by an item shares the others with it."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Generic, TypeVar, overload

T = TypeVar("T")


class Growing(Sequence[T], Generic[T]):
    """A sequence that is never changed. ``then`` gives one that is longer by one item: at once, as
    long as nothing else has been put after this one; else by copying it."""

    __slots__ = ("_items", "_size")

    def __init__(self, items: "list[T] | None" = None, size: int = 0):
        self._items: list[T] = [] if items is None else items
        self._size = size

    def then(self, item: T) -> "Growing[T]":
        """The sequence with one more item."""
        items = self._items
        if len(items) == self._size:
            items.append(item)
        elif items[self._size] is not item:
            items = [*items[: self._size], item]
        return Growing(items, self._size + 1)

    def first(self, size: int) -> "Growing[T]":
        """The first items, so many."""
        return Growing(self._items, size)

    def common(self, other: "Growing[T]") -> int:
        """How many items are the same at the beginning of both; little is to be done if the one
        was made of the other."""
        size = min(self._size, other._size)
        if self._items is other._items:
            return size
        pairs = zip(self._items, other._items, strict=False)
        same = enumerate(one is two or one == two for one, two in islice(pairs, size))
        return next((number for number, alike in same if not alike), size)

    def __len__(self) -> int:
        return self._size

    @overload
    def __getitem__(self, index: int) -> T: ...
    @overload
    def __getitem__(self, index: slice) -> "list[T]": ...
    def __getitem__(self, index: int | slice) -> "T | list[T]":
        if isinstance(index, slice):
            return [self._items[number] for number in range(*index.indices(self._size))]
        return self._items[range(self._size)[index]]

    def __iter__(self) -> Iterator[T]:
        return islice(iter(self._items), self._size)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Growing):
            return NotImplemented
        return self._size == other._size and self.common(other) == self._size

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        return f"Growing({[*self]})"
