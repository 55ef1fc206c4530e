"""Sequences that grow at their end; a longer one shares its items with a shorter one."""

from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Generic, TypeVar, overload

T = TypeVar("T")


class Growing(Sequence[T], Generic[T]):
    """A sequence that never changes.

    ``then`` makes a sequence that is longer by one item. This takes no time as long as nothing else
    was added after this sequence; otherwise it is copied.
    """

    __slots__ = ("_items", "_size")

    def __init__(self, items: "list[T] | None" = None, size: int = 0):
        self._items: list[T] = [] if items is None else items
        self._size = size

    def then(self, item: T) -> "Growing[T]":
        """Make the sequence with one more item."""
        items = self._items
        if len(items) == self._size:
            items.append(item)
        elif items[self._size] is not item:
            items = [*items[: self._size], item]
        return Growing(items, self._size + 1)

    def first(self, size: int) -> "Growing[T]":
        """Make the sequence of the first items, as many as ``size``."""
        return Growing(self._items, size)

    def common(self, other: "Growing[T]") -> int:
        """Count the items that are the same at the beginning of both sequences.

        This is quick if one was made from the other.
        """
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
