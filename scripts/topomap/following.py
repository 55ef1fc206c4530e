"""``topomap follow``: an experience that is read while it happens.

Each line is a step, in JSON or in facts, or takes steps back; it is read on top of what is
known, so that a line with a fault changes nothing.
"""

import argparse
import contextlib
import fcntl
import json
import os
import re
import select
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import clingo

from topomap import formats, words
from topomap.errors import DONE, NO, PARTIAL, InputError, of_file, say
from topomap.experience import (
    MARKER,
    SIGNATURES,
    cut_short,
    ground_facts,
    marker_fault,
    marker_out,
    misfit,
    slots_fault,
)
from topomap.explore import LIMITS, plan, standing
from topomap.online import Certain, Follower, Status
from topomap.options import LARGEST
from topomap.report import map_line, steps_json
from topomap.solver import INTERRUPT, Found, Stopped, Watch

KNOWN = {**SIGNATURES, "undo": "undo(N)"}  # of which undo is a line by itself
LONGEST = 2**20  # bytes of a line
PAUSE = 0.1  # seconds between two looks at a file
SHOWN = 3  # best maps that are told in text
_UNDO = re.compile(r"undo(?:\(\s*([0-9]{1,9})\s*\))?\s*\.\s*(?:%.*)?", re.ASCII | re.DOTALL)


@dataclass(frozen=True)
class Step:
    """What is known of a step, which may not be all as yet."""

    turn: int | None = None
    view: frozenset[int] = frozenset()
    landmarks: frozenset[str] = frozenset()
    marks: frozenset[str] = frozenset()  # of MARKER


@dataclass(frozen=True)
class Record:
    """What was read. Of the last step something may be missing."""

    slots: int | None = None
    steps: tuple[Step, ...] = ()

    def lack(self) -> str | None:
        """What the last step lacks."""
        if not self.steps:
            return None
        last, step = self.steps[-1], len(self.steps) - 1
        if self.slots is None:
            return "no slots(K)"
        if step and last.turn is None:
            return f"step {step}: no turn"
        if not last.view:
            return f"step {step}: no view"
        if 0 not in last.view:
            return f"step {step}: the view lacks slot 0, the gateway where the agent stands"
        return None

    def whole(self) -> tuple[Step, ...]:
        """The steps of which all is known."""
        return self.steps[:-1] if self.lack() else self.steps

    def read(self, line: str, source: str, number: int) -> "Record":
        """The record with one more line. Raises InputError if the line has a fault."""
        text = line.strip()
        try:
            if text.startswith(("{", "[")):
                return self._json(text)
            if match := _UNDO.fullmatch(text):
                return self._undone(int(match[1] or 1))
            record = self
            for _, fact in ground_facts(text):
                if isinstance(fact, str):
                    raise _Fault(fact)
                record = record._with(fact)
            return record._marked()
        except _Fault as fault:
            raise InputError(f"{source}:{number}: {fault}") from None

    def _with(self, fact: clingo.Symbol) -> "Record":
        if fault := misfit(fact, KNOWN):
            raise _Fault(fault)
        name, arguments = fact.name, fact.arguments
        if name == "undo":
            raise _Fault(f"{fact}: undo is a line by itself")
        first = arguments[0].number
        if name == "slots":
            return self._of(first)
        if name == "view":
            return self._seen(first, view=arguments[1].number)
        if name == "turn":
            return self._seen(first, turn=arguments[1].number)
        if name in MARKER:
            return self._seen(first, mark=name)
        return self._seen(first, landmark=str(arguments[1]))

    def _marked(self) -> "Record":
        """The record, if what is told of the marker can be."""
        out = False
        for number, step in enumerate(self.steps):
            if step.marks:
                if fault := marker_fault(step.marks, out):
                    raise _Fault(f"step {number}: {fault}")
                out = marker_out(step.marks, out)
        return self

    def _of(self, slots: int) -> "Record":
        if self.slots is not None:
            raise _Fault("slots are told twice")
        if fault := slots_fault(slots):
            raise _Fault(fault)
        if self.steps:
            raise _Fault("slots are to be told before the first step")
        return replace(self, slots=slots)

    def _seen(
        self,
        step: int,
        turn: int | None = None,
        view: int | None = None,
        landmark: str | None = None,
        mark: str | None = None,
    ) -> "Record":
        """The record with one more fact: of the last step, or of the next one."""
        if self.slots is None:
            raise _Fault("no slots(K) before the first step")
        last = len(self.steps) - 1
        if step not in (last, last + 1) or step < 0:
            may = f"{last} or {last + 1}" if last >= 0 else "0"
            raise _Fault(f"step {step}: it is {may} now")
        if step > last and (lack := self.lack()):
            raise _Fault(f"{lack}, but there is a later step")
        known = self.steps[step] if step == last else Step()
        for slot in (turn, view):
            if slot is not None and not 0 <= slot < self.slots:
                raise _Fault(f"step {step}: slot {slot} is not in 0..{self.slots - 1}")
        if turn is not None:
            if step == 0:
                raise _Fault("step 0: there is a turn, but step 1 is the first with a turn")
            if known.turn not in (None, turn):
                raise _Fault(f"step {step}: more than one turn")
            if turn not in self.steps[step - 1].view:
                raise _Fault(f"step {step}: turn {turn}: no gateway there after step {step - 1}")
            known = replace(known, turn=turn)
        if view is not None:
            known = replace(known, view=known.view | {view})
        if landmark is not None:
            known = replace(known, landmarks=known.landmarks | {landmark})
        if mark is not None:
            known = replace(known, marks=known.marks | {mark})
        return replace(self, steps=(*self.steps[:step], known))

    def _undone(self, steps: int) -> "Record":
        last = len(self.steps) - 1
        if not 0 < steps <= last:
            has = words.number(max(last, 0), "step")
            raise _Fault(f"undo of {words.number(steps, 'step')}: to take back: {has}")
        return replace(self, steps=self.steps[:-steps])

    def _json(self, text: str) -> "Record":
        try:
            data = json.loads(text)
        except (ValueError, RecursionError):
            raise _Fault("no JSON text") from None
        if not isinstance(data, dict):
            raise _Fault("a JSON object is wanted")
        begins = self.slots is None
        known = {"slots" if begins else "turn", "view", "landmarks", *MARKER}
        if data.keys() == {"undo"}:
            if not _is_number(data["undo"]):
                raise _Fault("undo: a whole number is wanted")
            return self._undone(data["undo"])
        for key in data:
            if key not in known:
                raise _Fault(f"{cut_short(json.dumps(key))}: not one of {', '.join(sorted(known))}")
        first = "slots" if begins else "turn"
        if not begins and not self.steps:
            first, known = "view", known - {"turn"}
        for key in dict.fromkeys((first, "view")):
            if key not in data:
                raise _Fault(f"{key} is missing")
        view, landmarks = data["view"], data.get("landmarks", [])
        if not isinstance(view, list) or not all(map(_is_number, view)):
            raise _Fault("view: a list of slots is wanted")
        if not isinstance(landmarks, list) or not all(isinstance(one, str) for one in landmarks):
            raise _Fault("landmarks: a list of terms, as text, is wanted")
        for name in MARKER:
            if not isinstance(data.get(name, False), bool):
                raise _Fault(f"{name}: true or false is wanted")
        if first != "view" and not _is_number(data[first]):
            raise _Fault(f"{first}: a whole number is wanted")
        record = self._of(data["slots"]) if begins else self
        step = len(record.steps)
        if lack := record.lack():
            raise _Fault(f"{lack}, but there is a later step")
        if step and "turn" in data:
            record = record._seen(step, turn=data["turn"])
        elif "turn" in data:
            raise _Fault("step 0: there is a turn, but step 1 is the first with a turn")
        for slot in view:
            record = record._seen(step, view=slot)
        for term in landmarks:
            facts = [fact for _, fact in ground_facts(f"landmark({step},{term}).")]
            for fact in facts:
                if isinstance(fact, str):
                    raise _Fault(fact)
                if len(facts) != 1 or len(fact.arguments) != 2:
                    raise _Fault(f"landmarks: {cut_short(json.dumps(term))} is not a ground term")
                record = record._with(fact)
        for name in MARKER:
            if data.get(name):
                record = record._seen(step, mark=name)
        if lack := record.lack():
            raise _Fault(lack)
        return record._marked()


class _Fault(Exception):
    """What is wrong with a line."""


def _is_number(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and abs(value) <= LARGEST


class Log:
    """The lines that were accepted, in a file. Raises InputError where it cannot be had."""

    def __init__(self, path: str):
        self.path = path
        self._file: int | None = None

    def open(self, make: bool) -> None:
        """Have the file, and nobody else; made only when there is something to write."""
        flags = os.O_RDWR | os.O_APPEND | (os.O_CREAT if make else 0)
        try:
            self._file = os.open(self.path, flags, 0o666)
            if not Path(self.path).is_file():
                raise InputError(f"{self.path}: no regular file")
            fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise InputError(f"{self.path}: another follower has it") from None
        except FileNotFoundError as error:
            if make or not Path(self.path).parent.is_dir():
                raise of_file(self.path, error) from None
        except OSError as error:
            raise of_file(self.path or "an empty name", error) from None
        except ValueError:
            raise InputError(f"{self.path}: not the name of a file") from None

    def lines(self) -> Iterator[tuple[int, bytes]]:
        """The lines that it has. A last one that was torn is dropped."""
        self.open(make=False)
        if self._file is None:
            return
        with os.fdopen(os.dup(self._file), "rb") as file:
            whole = 0
            for number, line in enumerate(file, 1):
                if not line.endswith(b"\n"):
                    say(f"{self.path}:{number}: torn, dropped")
                    os.ftruncate(self._file, whole)
                    return
                whole += len(line)
                yield number, line

    def add(self, line: str) -> None:
        """Write a line, so that it is there whatever comes."""
        if self._file is None:
            self.open(make=True)
        assert self._file is not None
        try:
            left = line.strip().encode() + b"\n"
            while left:
                left = left[os.write(self._file, left) :]
            os.fsync(self._file)
        except OSError as error:
            raise of_file(self.path, error) from None


def lines(path: str, wait: bool, stopped: Callable[[], None]) -> Iterator[bytes]:
    """The lines of standard input to its end, or of a file as it grows; the last one when it
    is whole, or when no more is to come. ``stopped`` raises if it is to end."""
    try:
        file = os.dup(0) if path == "-" else os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    except OSError as error:
        raise of_file(path or "an empty name", error) from None
    except ValueError:
        raise InputError(f"{path}: not the name of a file") from None
    grows = wait and path != "-"
    rest, read = bytearray(), 0
    with contextlib.ExitStack() as stack:
        stack.callback(os.close, file)
        while True:
            stopped()
            try:
                if not select.select([file], [], [], PAUSE)[0]:
                    continue
                chunk = os.read(file, 2**16)
            except BlockingIOError:
                continue
            except OSError as error:
                raise of_file(path, error) from None
            read += len(chunk)
            *whole, last = (rest + chunk).split(b"\n")
            yield from map(bytes, whole)
            rest = bytearray(last)
            if len(rest) > LONGEST:
                yield bytes(rest)
                return
            if chunk:
                continue
            if not grows:
                break
            if os.fstat(file).st_size < read:
                raise InputError(f"{path}: it became shorter")
            time.sleep(PAUSE)
        if rest:
            yield bytes(rest)


def decoded(line: bytes, source: str, number: int) -> str:
    """The text of a line. Raises InputError if it is none."""
    if len(line) > LONGEST:
        raise InputError(f"{source}:{number}: longer than {LONGEST >> 20} MiB")
    try:
        text = line.decode("utf-8-sig" if number == 1 else "utf-8")
    except UnicodeDecodeError:
        text = "\0"
    if "\0" in text:
        raise InputError(f"{source}:{number}: not text")
    return text


class Following:
    """The follower, and what it tells after each step."""

    def __init__(self, args: argparse.Namespace):
        self.args = args
        self.record = Record()
        self.follower: Follower | None = None
        self.certain: list[Certain] = []  # by steps
        self.status = DONE

    def take(self, record: Record) -> Iterator[int]:
        """Go to what a record says; the steps at which it stands on the way."""
        old, new = self.record.whole(), record.whole()
        self.record = record
        common = 0
        while common < min(len(old), len(new)) and old[common] == new[common]:
            common += 1
        if common < len(old):
            del self.certain[common:]
            if common:
                assert self.follower is not None
                self.follower.undo(len(old) - common)
            else:
                self.follower = None
            if common == len(new) > 0:
                del self.certain[common - 1 :]
                yield common - 1
        for step in range(common, len(new)):
            self._go(new[step])
            yield step

    def _go(self, step: Step) -> None:
        if self.follower is None:
            assert self.record.slots is not None
            self.follower = Follower(
                self.record.slots,
                step.view,
                step.landmarks,
                self.args.planar,
                self.args.bound,
                self.args.count_limit,
                step.marks,
            )
        else:
            assert step.turn is not None
            self.follower.step(step.turn, step.view, step.landmarks, step.marks)

    def tell(self, begun: float) -> None:
        """Print what is known now."""
        assert self.follower is not None
        with Watch(self.args.timeout) as watch:
            status = self.follower.status(watch)
            before = self.certain[-1] if self.certain else Certain()
            following, fault = None, status.fault
            if status.best and not fault:
                following, fault = self._plan(status, watch)
        if fault == INTERRUPT:
            raise Stopped(INTERRUPT)
        self.certain += [before] * (status.step - len(self.certain))
        self.certain.append(before if status.certain is None else status.certain)
        new = self.certain[-1].since(before)
        self.status = PARTIAL if fault or self.status == PARTIAL else DONE
        if self.status == DONE and status.none_since is not None:
            self.status = NO
        if self.args.json:
            answer = _json(status, new, following)
            answer["seconds"] = round(time.monotonic() - begun, 4)
            print(formats.line(answer, fault), end="", flush=True)
        else:
            text = _text(self.follower, status, new, following, fault, time.monotonic() - begun)
            print(text, flush=True)

    def _plan(self, status: Status, watch: Watch) -> tuple[dict[str, Any] | None, str | None]:
        """The next best action: what explore says of the best maps; and why the planning was cut,
        if it was. None if no walk was found, and it is open whether there is one."""
        assert self.follower is not None
        experience = self.follower.experience
        among = [standing(experience, at) for at in status.best]
        made = plan(experience.slots, among, watch, marker=self.args.marker)
        fault = None if made.fault in LIMITS else made.fault
        if not made.turns and made.kind not in ("settled", "bisimilar"):
            return None, fault
        return {
            "kind": made.kind,
            "turns": list(made.turns),
            "drop": made.drop,
            "left": made.left,
            "proved": made.proved,
        }, fault


def _json(status: Status, new: Certain, following: dict[str, Any] | None) -> dict[str, Any]:
    """What is known after a step; None where it is open."""
    settled = status.all_best or bool(status.best)
    return {
        "step": status.step,
        "hypotheses": status.hypotheses,
        "exact": status.exact if status.hypotheses is not None else None,
        "none_since": status.none_since,
        "best": {
            "kind": status.kind,
            "cost": list(status.cost) if settled else None,
            "count": len(status.best) if settled else None,
            "all": status.all_best if settled else None,
            "maps": [steps_json(at) for at in status.best],
        },
        "certain": {
            "same": sorted(map(list, new.same)),
            "new": sorted(new.new),
            "linked": sorted(map(list, new.linked)),
        }
        if status.certain is not None
        else None,
        "next": following,
    }


def _text(
    follower: Follower,
    status: Status,
    new: Certain,
    following: dict[str, Any] | None,
    fault: str | None,
    seconds: float,
) -> str:
    if status.none_since is not None:
        since = f" since step {status.none_since}" if status.none_since < status.step else ""
        return f"step {status.step}: no hypothesis is left{since} ({seconds:.2f} s)"
    more = "" if status.exact else "more than "
    noun = words.number(status.hypotheses or 0, "hypothesis", "hypotheses")
    told = f"{more}{noun}" if status.hypotheses is not None else "hypotheses not counted"
    out = [f"step {status.step}: {told} ({seconds:.2f} s)"]
    facts = [f"same({t},{u})" for t, u in sorted(new.same)]
    facts += [f"new({t})" for t in sorted(new.new)]
    facts += [f"linked({t},{s},{u},{r})" for t, s, u, r in sorted(new.linked)]
    if facts:
        rest = f" and {len(facts) - words.MOST:,} more" if len(facts) > words.MOST else ""
        out.append(f"  certain now: {' '.join(facts[: words.MOST])}{rest}")
    for number, at in enumerate(status.best[:SHOWN], 1):
        out.append(f"  map {number}: {map_line(follower.experience, Found(at, ''))}")
    if status.kind:
        count = words.number(len(status.best), f"{status.kind} map")
        many = "" if status.all_best else "more than "
        out.append(f"  {many}{count}, cost {' '.join(map(str, status.cost))}")
    elif status.all_best and not fault:
        out.append("  no map has consistent boundaries")
    if following is not None:
        seen = follower.experience
        out.append(f"  next: {_next(following, seen.slots, seen.steps, status.all_best)}")
    elif status.best and not fault:
        out.append("  next: a walk that tells the best maps apart is not found")
    if fault:
        out.append(f"  partial: {fault}")
    return "\n".join(out)


def _next(following: dict[str, Any], slots: int, steps: int, every: bool) -> str:
    told = [words.direction(turn, slots) for turn in following["turns"]]
    if steps == 0 and told:  # it arrived by no gateway, so there is no way back
        told[0] = "by the gateway stood at" if following["turns"][0] == 0 else ""
    drop = following["drop"]
    walk = ", ".join(
        " ".join(filter(None, [str(turn), f"({'; '.join(how)})" * bool(how)]))
        for step, (turn, word) in enumerate(zip(following["turns"], told, strict=True))
        for how in [[*["the marker put down before"] * (step == drop), *filter(None, [word])]]
    )
    left = words.number(following["left"], "map")
    return {
        "apart": f"turn {walk}: of the best maps it leaves {left} at most",
        "pending": f"turn {walk}: to a pending gateway",
        "settled": "nothing; the only best map is closed",
        "bisimilar": f"nothing; no walk tells {'the' if every else 'these'} {left} apart",
    }[following["kind"]]


def follow(args: argparse.Namespace) -> int:
    """Read an experience as it happens, and tell after each step what is known."""
    if args.log is not None and args.file != "-":
        raise InputError("topomap follow: --log is for standard input; a FILE is its own log")
    following = Following(args)
    log = Log(args.log) if args.log is not None else None
    source = "standard input" if args.file == "-" else args.file
    with Watch(quiet=True) as outer:
        coming = lines(args.file, args.wait, outer.tick)
        try:
            if log:
                _replay(following, log)
            for number, line in enumerate(coming, 1):
                begun = time.monotonic()
                try:
                    text = decoded(line, source, number)
                    read = following.record.read(text, source, number)
                except InputError as error:
                    if not args.keep_going:
                        raise
                    say(str(error))
                    continue
                if log and read != following.record:
                    log.add(text)
                for _ in following.take(read):
                    following.tell(begun)
                    begun = time.monotonic()
                    outer.tick()
        except Stopped:
            raise KeyboardInterrupt from None
    if (lack := following.record.lack()) or not following.record.steps:
        raise InputError(f"{source}: {lack or 'no step in it'}")
    return following.status


def _replay(following: Following, log: Log) -> None:
    """Go to where a log ends, and say what is known there."""
    record = Record()
    for number, line in log.lines():
        record = record.read(decoded(line, log.path, number), log.path, number)
    begun = time.monotonic()
    for _ in following.take(record):
        pass
    if record.whole():
        following.tell(begun)
