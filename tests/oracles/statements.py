"""Statements about hypotheses, and whether they hold, by the independent search's own means."""

from oracles.brute_force import Hypothesis, counterpart


def gateway(h, step, slot):
    """The gateway so many slots clockwise of where the agent stood after a step."""
    if h.inexact and slot not in h.views[step]:
        return h.at[step][0], None
    return counterpart(h.slots, h.views, h.at, step, slot, h.inexact)


def one_path(h, one, other):
    """Whether two gateways are there, and one path leads through both."""

    there = all(slot in h.stars[place] for place, slot in (one, other))
    paths = [{*path} | {h.opposite(heading) for heading in path} for path in h.paths()]
    return there and any({one, other} <= path for path in paths)


RELATIONS = {
    "same": lambda h, t, u: h.at[t][0] == h.at[u][0],
    "linked": lambda h, t, s, u, r: h.link.get(gateway(h, t, s)) == gateway(h, u, r),
    "path": lambda h, t, s, u, r: one_path(h, gateway(h, t, s), gateway(h, u, r)),
    "pending": lambda h, t, s: gateway(h, t, s) in h.pending(),
    "at": lambda h, t, p, s: h.at[t] == (p, s),
}
FIGURES = {
    "places": lambda h: len(h.stars),
    "paths": lambda h: len(h.paths()),
    "links": lambda h: len(h.link) // 2,
    "pending": lambda h: len(h.pending()),
    "genus": Hypothesis.genus,
    "exceptions": lambda h: sum(h.exceptions()),
}
PROPERTIES = {
    "planar": lambda h: h.genus() == 0,
    "closed": Hypothesis.closed,
    "travelled": Hypothesis.travelled,
    "boundary": Hypothesis.boundary,
    "perpendicular": Hypothesis.perpendicular,
}
QUALITIES = {
    **PROPERTIES,
    "circular": lambda h: any(h.opposite(gateway) in h.ray(gateway) for gateway in h.link),
    "meets_twice": lambda h: h.exceptions()[0] > 0,
}


def ends(draw, experience):
    """Gateways, each as a step and a slot: the two ends of what a step took, or other ones."""
    last = experience.steps
    step = max(draw.randint(0, last), draw.randint(0, last))
    travels = step and experience.turns[step - 1] is not None
    taken = [(step - 1, experience.turns[step - 1]), (step, 0)] if travels else []
    if draw.random() < 0.1:
        slot = draw.choice(sorted(experience.views[step]))
        taken = [(step, slot), (step, (slot + experience.slots // 2) % experience.slots)]
    draw.shuffle(taken)
    while len(taken) < 2 or draw.random() < 0.3:
        step = max(draw.randint(0, last), draw.randint(0, last))
        seen = draw.random() < 0.9
        slot = draw.choice(sorted(experience.views[step]) if seen else range(experience.slots))
        taken[draw.randint(0, 1) :] = [(step, slot)]
    return taken


def relation(draw, experience, kind):
    """The arguments of a statement of this kind."""
    (t, s), (u, r) = ends(draw, experience)
    short = {"same": [t, u], "pending": [t, s], "at": [max(t, u), min(t, u), s]}
    return short.get(kind, [t, s, u, r])
