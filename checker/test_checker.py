"""False proofs for every guard of the checker; and tampering: 500 pairs of a scenario and a certificate, of which one was changed,
with the truth by another route.

    FORWARDSTEP_CERTIFICATES=FOLDER python3 -m unittest checker/test_checker.py

FOLDER holds NAME.json for every scenario below; a test of the program makes it. The truth comes from `truth`: floating point,
transitive closures, sampling and determinants, where the checker follows trees, encloses, and eliminates.
"""

import copy
import decimal
import functools
import itertools
import json
import math
import os
import random
import sys
import tempfile
import tomllib
import unittest
from itertools import permutations
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import forwardstep_checker as checker  # noqa: E402

SCENARIOS = HERE.parent / "crates" / "io" / "scenarios"
NAMES = ("theorem-1", "theorem-2", "theorem-3-a5-order-3", "theorem-3-24-order-4", "theorem-8", "first-order",
         "five-ships", "saturated-coupling", "formulas", "cut")
# As many as a release needs, or a sample of them.
LONG = "FORWARDSTEP_LONG" in os.environ
PAIRS = 500 if LONG else 24
SEED = 11


def place_of(name):
    own = HERE / "cases" / f"{name}.toml"
    return own if own.is_file() else SCENARIOS / f"{name}.toml"


def often(count):
    """So many draws before a release, and a quarter of them for every change."""
    return range(count if LONG else count // 4)


def written(value):
    """A value as TOML, tables inline."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value)
    if isinstance(value, list):
        return "[" + ", ".join(written(entry) for entry in value) + "]"
    return "{ " + ", ".join(f"{key} = {written(entry)}" for key, entry in value.items()) + " }"


def document(scenario):
    return "\n".join(f"{key} = {written(value)}" for key, value in scenario.items()) + "\n"


# --- The truth by another route

def names_of(scenario):
    names = []
    for entry in scenario["agents"]:
        count = entry.get("count")
        names += [entry["name"]] if count is None else [f"{entry['name']}-{k + 1}" for k in range(count)]
    return names + (["leader"] if "leader" in scenario else [])


def graphs_of(scenario):
    """For every phase {(from, to): (weight, delay)}."""
    network = scenario["network"]
    usual = network.get("weight", 1), network.get("delay", {"constant_s": 0})
    graphs = []
    for edges in [network["edges"]] if "edges" in network else [phase["edges"] for phase in network["phases"]]:
        graph = {}
        for edge in edges:
            own = edge if isinstance(edge, dict) else {"from": edge[0], "to": edge[1]}
            graph[own["from"], own["to"]] = own.get("weight", usual[0]), own.get("delay", usual[1])
        graphs.append(graph)
    return graphs


def closure(names, edges):
    """Who is reached by whom, by Warshall's algorithm."""
    reached = {(a, a) for a in names} | set(edges)
    for k in names:
        for i in names:
            if (i, k) in reached:
                reached |= {(i, j) for j in names if (k, j) in reached}
    return reached


def value_at(text, t):
    return eval(text.replace("^", "**"), {"__builtins__": {}}, {**vars(math), "abs": abs, "min": min, "max": max, "t": t})


def sampled(text, end_s):
    values = [value_at(text, end_s * k / 4000) for k in range(4001)]
    return min(values), max(values)


def longest(delay, end_s):
    """The largest delay among many samples."""
    (kind, body), = delay.items()
    if kind == "constant_s":
        return body
    if kind == "sinusoid":
        return max(body["mean_s"] + body["amplitude_s"] * math.sin(k / 100) for k in range(700))
    if kind == "saw_tooth":
        return max(body["min_s"] + (body["max_s"] - body["min_s"]) * k / 10000 for k in range(10000))
    if kind == "piecewise_constant":
        return sorted(body["values_s"])[-1]
    return sampled(body, end_s)[1]


def number(text):
    top, _, bottom = str(text).partition("/")
    return float(top) / float(bottom or 1)


def determinant(rows):
    """By Leibniz' formula."""
    n, total = len(rows), 0.0
    for order in permutations(range(n)):
        sign = (-1) ** sum(order[i] > order[j] for i in range(n) for j in range(i + 1, n))
        total += sign * math.prod(rows[i][order[i]] for i in range(n))
    return total


def near(a, b):
    return abs(a - b) <= 1e-6 * max(1.0, abs(a), abs(b))


def windows_are_true(scenario, windows, sequence, exact_end=True):
    names, graphs, led = names_of(scenario), graphs_of(scenario), "leader" in scenario
    covered = [phase for window in windows for phase in window["phases"]]
    if not windows or any(not window["phases"] for window in windows):
        return False
    if (covered != sequence) if exact_end else (covered != sequence[:len(covered)]):
        return False
    for window in windows:
        steps = [tuple(step) for step in window["arborescence"]]
        if any(phase not in window["phases"] or (a, b) not in graphs[phase - 1] for a, b, phase in steps):
            return False
        seen = {window["root"]}
        for a, b, _ in steps:
            if a not in seen:
                return False
            seen.add(b)
        reached = closure(names, {(a, b) for a, b, _ in steps})
        if window["root"] not in names or any((window["root"], name) not in reached for name in names):
            return False
        if led and window["root"] != "leader":
            return False
    return True


def tree_is_true(scenario, entry):
    graphs, network = graphs_of(scenario), scenario["network"]
    proof, switching = entry["proof"], network.get("switching", "repeat")
    recurring = list(range(1, len(graphs) + 1))
    if switching == "once" or "edges" in network:
        recurring = recurring[-1:]
    if proof["kind"] == "windows" and not isinstance(switching, dict):
        count = sum(len(window["phases"]) for window in proof["windows"]) / len(recurring)
        right = "holds" in entry["answer"] and count == int(count)
        return right and windows_are_true(scenario, proof["windows"], recurring * int(count))
    if proof["kind"] == "drawn" and isinstance(switching, dict):
        low, high = switching["random"]["dwell_s"]
        times = [0.0] + [number(one["until_s"]) for one in proof["given"]]
        if any(not low - 1e-6 <= b - a <= high + 1e-6 for a, b in zip(times, times[1:])) or times[-1] < scenario["time"]["end_s"]:
            return False
        sequence = [one["phase"] for one in proof["given"]]
        if any(not 1 <= phase <= len(graphs) for phase in sequence):
            return False
        if not windows_are_true(scenario, proof["windows"], sequence, exact_end=False):
            return False
        ends = [0]
        for window in proof["windows"]:
            ends.append(ends[-1] + len(window["phases"]))
        lengths = [times[b] - times[a] for a, b in zip(ends, ends[1:])] + [scenario["time"]["end_s"] - times[ends[-1]]]
        return entry["answer"] == "holds on [0, end]" and max(lengths) <= number(proof["longest_s"]) + 1e-9
    if proof["kind"] == "cut":
        groups, names = [set(group) for group in proof["groups"]], names_of(scenario)
        edges = {pair for phase in recurring for pair in graphs[phase - 1]}
        # Nobody outside reaches anybody inside.
        reached = closure(names, edges)
        closed = all((a, b) not in reached for group in groups for b in group for a in set(names) - group)
        apart = sum(map(len, groups)) == len(set().union(*groups)) and all(groups) and set().union(*groups) <= set(names)
        return entry["answer"] == "violated" and len(groups) > 1 and closed and apart
    return False


def enclosures_are_true(scenario, entries, part, fine):
    """Sampled, each formula keeps within what is stated; {text: within}."""
    graphs, found = graphs_of(scenario), {}
    for entry in entries:
        a, b, phase = entry["edge"]
        if not 1 <= phase <= len(graphs) or (a, b) not in graphs[phase - 1]:
            return None
        text = graphs[phase - 1][a, b][part]
        text = text.get("formula_s") if isinstance(text, dict) else text
        if not isinstance(text, str):
            return None
        low, high = sampled(text, scenario["time"]["end_s"])
        within = [number(end) for end in entry["within"]]
        if not (within[0] <= low + 1e-9 and high <= within[1] + 1e-9 and fine(within[0])):
            return None
        found[text] = within
    return found


def links_are_true(scenario, entry):
    proof, graphs, end_s = entry["proof"], graphs_of(scenario), scenario["time"]["end_s"]
    if entry["id"] == "bounded-weights":
        found = enclosures_are_true(scenario, proof["enclosures"], 0, lambda low: low > 0)
        texts = {weight for graph in graphs for weight, _ in graph.values() if isinstance(weight, str)}
        return found is not None and texts <= set(found)
    found = enclosures_are_true(scenario, proof["enclosures"], 1, lambda low: low >= 0)
    if found is None or proof["given"]:
        return False
    bound = number(proof["bound_s"])
    for graph in graphs:
        for _, delay in graph.values():
            text = delay.get("formula_s")
            if text is not None and (text not in found or found[text][1] > bound):
                return False
            if longest(delay, end_s) > bound + 1e-9:
                return False
    return True


def roots_of(scenario):
    shared = next(iter(scenario["reference"].values())).get("roots_per_s", [])
    found = {}
    for entry in scenario["agents"]:
        own = next(iter(entry["reference"].values()))["roots_per_s"] if "reference" in entry else shared
        for name in names_of({"agents": [entry]}):
            found[name] = own
    return found


def numbers_are_true(scenario, entry):
    value, roots = number(entry["proof"]["value"]), roots_of(scenario)
    every = [root for own in roots.values() for root in own]
    if entry["id"] in ("real-roots", "hurwitz"):
        real = entry["id"] == "hurwitz" or not any(isinstance(root, dict) for root in every)
        return real and 0 < value and all((root["real"] if isinstance(root, dict) else root) >= value for root in every)
    orders = [sum(2 if isinstance(root, dict) else 1 for root in own) for own in roots.values()]
    return entry["id"] == "common-order" and all(order == value for order in orders)


def first_roots_are_true(scenario, entry):
    names, roots = names_of(scenario), roots_of(scenario)
    classes = entry["proof"].get("classes", [])
    if sorted(name for group in classes for name in group) != sorted(names):
        return False
    edges = [pair for graph in graphs_of(scenario) for pair in graph]
    reached = closure(names, edges)
    mates = [(a, b) for a in names for b in names if (a, b) in reached and (b, a) in reached]
    at = {name: k for k, group in enumerate(classes) for name in group}
    first = {name: next((root for root in own if not isinstance(root, dict)), None) for name, own in roots.items()}
    same = all(first[a] == first[b] for group in classes for a in group for b in group)
    return same and all(at[a] == at[b] for a, b in mates) and all(at[a] <= at[b] for a, b in edges)


def gains_are_true(scenario, entry):
    """Pivots are quotients of leading minors; what is stated may be less."""
    stated = {(one["agent"], one["gain"]): [number(pivot) for pivot in one["pivots"]] for one in entry["proof"]["matrices"]}
    for own in scenario["agents"]:
        law = own.get("law", scenario.get("law", {"adaptive": {}}))
        body = next(iter(law.values()))
        for key in ("damping", "adaptation_gain", "gain_per_s"):
            value = body.get(key)
            value = next(iter(value.values())) if isinstance(value, dict) else value
            if isinstance(value, list) and isinstance(value[0], list):
                if any(row[j] != value[j][i] for i, row in enumerate(value) for j in range(len(value))):
                    return False
                minors = [determinant([row[:k] for row in value[:k]]) for k in range(1, len(value) + 1)]
                for name in names_of({"agents": [own]}):
                    pivots = stated.get((name, key), [])
                    if len(pivots) != len(minors) or min(minors) <= 0 or min(pivots) <= 0:
                        return False
                    found = [minor / before for before, minor in zip([1, *minors], minors)]
                    if not all(own <= one or near(own, one) for own, one in zip(pivots, found)):
                        return False
            elif value is not None and min(value if isinstance(value, list) else [value]) <= 0:
                return False
    return True


def drive_at(swing, alpha, t):
    """α q̇ + q̈ of a sum of sinusoids."""
    return sum(wave["amplitude"] * wave["rad_per_s"] * (
        alpha * math.cos(wave["rad_per_s"] * t + wave.get("phase_rad", 0))
        - wave["rad_per_s"] * math.sin(wave["rad_per_s"] * t + wave.get("phase_rad", 0))) for wave in swing["waves"])


def sign_gain_is_true(scenario, entry):
    reference, swings = scenario["reference"]["leader"], scenario["leader"]["motion"]["sinusoids"]
    bounds = entry["proof"]["bounds"]
    if len(bounds) != len(swings):
        return False
    for swing, bound in zip(swings, bounds):
        values = [drive_at(swing, reference["roots_per_s"][0], k / 50) for k in range(5000)]
        low, high = map(number, bound["within"])
        if not (low <= min(values) and max(values) <= high and max(abs(low), abs(high)) < reference["gain"]):
            return False
    return True


def least_minor(robot):
    """The least determinant of M at many postures, and of its last entry."""
    if "point_mass" in robot:
        return robot["point_mass"]["mass_kg"]
    if "ship" in robot:
        of = robot["ship"]["inertia"]
        return min(of["surge_kg"], of["sway_kg"], of["sway_kg"] * of["yaw_kg_m2"] - of.get("sway_yaw_kg_m", 0) ** 2)
    body = robot["planar_arm"]
    (m_1, m_2), (l_1, l_2) = body["mass_kg"], body["length_m"]
    c_1, c_2 = body.get("com_m", (l_1 / 2, l_2 / 2))
    i_1, i_2 = body.get("inertia_kg_m2", (m_1 * l_1 ** 2 / 12, m_2 * l_2 ** 2 / 12))
    last = i_2 + m_2 * c_2 ** 2

    def determinant(q_2):
        across = last + m_2 * l_1 * c_2 * math.cos(q_2)
        return (i_1 + m_1 * c_1 ** 2 + m_2 * l_1 ** 2 + 2 * across - last) * last - across ** 2

    return min([last] + [determinant(k * math.pi / 100) for k in range(101)])


def entry_is_true(scenario, entry):
    """Whether a claim is so and its proof shows it."""
    each, network = entry["id"], scenario["network"]
    if each in ("spanning-tree", "leader-reaches-all"):
        return tree_is_true(scenario, entry)
    # What holds for ever holds on the run.
    if not entry["answer"].startswith("holds"):
        return False
    if each == "dwell-time":
        if entry["proof"]["kind"] == "never-switches":
            return len(graphs_of(scenario)) == 1
        switching = network.get("switching", "repeat")
        dwell = [phase["dwell_s"] for phase in network.get("phases", []) if "dwell_s" in phase]
        dwell = switching["random"]["dwell_s"] if isinstance(switching, dict) else dwell
        return bool(dwell) and 0 < number(entry["proof"]["shortest_s"]) <= min(dwell)
    if each in ("bounded-delays", "bounded-weights"):
        return links_are_true(scenario, entry)
    if each in ("real-roots", "hurwitz", "common-order"):
        return numbers_are_true(scenario, entry)
    if each == "common-first-root":
        return first_roots_are_true(scenario, entry)
    if each in ("positive-gains", "chain-adaptation"):
        return gains_are_true(scenario, entry)
    if each == "sign-gain":
        return sign_gain_is_true(scenario, entry)
    if each == "coupling-sector":
        return {entry["proof"]["form"]: number(entry["proof"]["size"])} == network["coupling"]
    if each == "applied-torque":
        return not any(own.get("enforce_limits") for own in scenario["agents"])
    if each == "no-delay":
        return all(longest(delay, 1) == 0 for graph in graphs_of(scenario) for _, delay in graph.values())
    if each == "bounded-leader":
        return entry["proof"]["order"] >= 3
    if each == "uniform-inertia":
        return all(least_minor(own["robot"]) > 1e-9 for own in scenario["agents"])
    return each in ("fixed-graph", "input-factor", "set-valued-sign", "shared-design", "bounded-dynamics", "defined-terms")


def agreement_is_true(scenario, shares):
    """uᵀL = 0 and Σu = 1, dense."""
    names, graph = names_of(scenario), graphs_of(scenario)[0]
    u = {name: number(share) for name, share in shares}
    if sorted(name for name, _ in shares) != sorted(names) or min(u.values()) < 0 or not near(sum(u.values()), 1):
        return False
    laplacian = {(i, j): 0.0 for i in names for j in names}
    for (source, to), (weight, _) in graph.items():
        laplacian[to, to] += weight
        laplacian[to, source] -= weight
    return all(near(sum(u[i] * laplacian[i, j] for i in names), 0) for j in names)


def truth(scenario, certificate, required):
    """Whether a certificate is right about a scenario, in all that it claims."""
    entries = certificate["hypotheses"]
    if [entry["id"] for entry in entries] != required:
        return False
    claims = [entry for entry in entries if entry["answer"].startswith("holds") or entry["answer"] == "violated"]
    shares = certificate.get("agreement", {}).get("influence")
    return all(entry_is_true(scenario, entry) for entry in claims) and (shares is None or agreement_is_true(scenario, shares))


# --- Changes

def edge_lists(scenario):
    network = scenario["network"]
    return [network["edges"]] if "edges" in network else [phase["edges"] for phase in network["phases"]]


def drop_edge(scenario, _, draw):
    edges = draw.choice(edge_lists(scenario))
    edges.pop(draw.randrange(len(edges)))


def add_edge(scenario, _, draw):
    edges = draw.choice(edge_lists(scenario))
    known = {tuple(edge) if isinstance(edge, list) else (edge["from"], edge["to"]) for edge in edges}
    names = [name for name in names_of(scenario)]
    free = [(a, b) for a in names for b in names if a != b and b != "leader" and (a, b) not in known]
    edges.append(list(draw.choice(free)))


def shuffle_edges(scenario, _, draw):
    for edges in edge_lists(scenario):
        draw.shuffle(edges)


def change_weight(scenario, _, draw):
    weight = scenario["network"].get("weight", 1.0)
    if isinstance(weight, str):
        scenario["network"]["weight"] = draw.choice((weight.replace("2.5 +", "2.1 +"), weight.replace("1.5*", "1.2*"), weight.replace("2.5 +", "4 +")))
    else:
        edges = draw.choice(edge_lists(scenario))
        k = draw.randrange(len(edges))
        if isinstance(edges[k], list):
            edges[k] = {"from": edges[k][0], "to": edges[k][1], "weight": draw.choice((0.5, 3.0))}


def change_dwell(scenario, _, draw):
    network = scenario["network"]
    factor = draw.choice((0.5, 0.9, 1.0, 1.5, 4.0))
    if isinstance(network.get("switching"), dict):
        network["switching"]["random"]["dwell_s"][draw.randrange(2)] *= factor
        network["switching"]["random"]["dwell_s"].sort()
    elif "phases" in network and "dwell_s" in (phase := draw.choice(network["phases"])):
        phase["dwell_s"] *= factor


def change_delay(scenario, _, draw):
    delay = scenario["network"].get("delay", {"constant_s": 0.0})
    (kind, body), = delay.items()
    factor = draw.choice((0.5, 0.9, 1.0, 1.1, 3.0))
    if kind == "constant_s":
        delay[kind] = body * factor
    elif kind == "piecewise_constant":
        body["values_s"] = [value * factor for value in body["values_s"]]
    elif kind == "formula_s":
        delay[kind] = draw.choice((body.replace("0.1*", "0.05*"), body.replace("0.1*", "0.15*"), body.replace("/3)", "/4)"), "0.1 + 0*t"))
    else:
        key = draw.choice([key for key in ("max_s", "mean_s", "amplitude_s") if key in body])
        body[key] *= factor if key != "amplitude_s" else min(factor, 1.0)
        body[key] = max(body[key], body.get("min_s", 0), body["amplitude_s"] if key == "mean_s" else 0)


def change_root(scenario, _, draw):
    lists = [next(iter(scenario["reference"].values()))["roots_per_s"]]
    lists += [next(iter(own["reference"].values()))["roots_per_s"] for own in scenario["agents"] if "reference" in own]
    roots = draw.choice(lists)
    k = draw.randrange(len(roots))
    if "consensus" in scenario["reference"] and len(roots) > 1 and draw.random() < 0.25:
        roots[:2] = [{"real": max(roots[:2]), "imaginary": 0.5}]
    else:
        roots[k] = draw.choice((roots[k] * 2, roots[k] / 2, roots[k]))


def change_gain(scenario, _, draw):
    tables = [own["law"] for own in scenario["agents"] if "law" in own] + ([scenario["law"]] if "law" in scenario else [])
    for law in tables:
        body = next(iter(law.values()))
        gain = body.get("damping", {}).get("gain") if isinstance(body.get("damping"), dict) else None
        if isinstance(gain, list) and isinstance(gain[0], list):
            k = draw.randrange(len(gain))
            gain[k][k] = draw.choice((gain[k][k], gain[k][k] * 2, 0.01))
            return
    if "leader" in scenario:
        scenario["reference"]["leader"]["gain"] = draw.choice((0.5, 1.5, 4.0))


def change_leader(scenario, _, draw):
    if "leader" in scenario:
        wave = draw.choice(scenario["leader"]["motion"]["sinusoids"])["waves"][0]
        wave["amplitude"] *= draw.choice((0.5, 1.0, 3.0))


def change_words(scenario, _, draw):
    scenario["title"] = "Something else"
    scenario["goal"] = {"disagreement_below" if "leader" not in scenario else "error_below": 0.5}
    scenario["time"]["record_every_s"] = draw.choice((0.1, 0.2))


def reorder_agents(scenario, _, draw):
    draw.shuffle(scenario["agents"])


def enforce_limits(scenario, _, draw):
    draw.choice(scenario["agents"])["enforce_limits"] = draw.choice((True, False))


def change_end(scenario, _, draw):
    scenario["time"]["end_s"] = scenario["time"]["end_s"] * draw.choice((0.5, 1, 3))


def leaves(value, path=()):
    """Places of texts and numbers in a document."""
    if isinstance(value, (dict, list)):
        for key, entry in value.items() if isinstance(value, dict) else enumerate(value):
            yield from leaves(entry, (*path, key))
    else:
        yield path


def spoil(_, certificate, draw):
    """Changes one text or number to another that a certificate might have."""
    places = [path for path in leaves(certificate) if path[0] in ("hypotheses", "agreement") and path[-1] not in ("kind", "id", "range", "cells")]
    *path, last = draw.choice(places)
    held = certificate
    for key in path:
        held = held[key]
    value = held[last]
    texts = sorted({text for text in everywhere(certificate) if isinstance(text, str) and ("-" in text or text.isalpha())})
    if last == "answer":
        held[last] = draw.choice(("holds", "holds on [0, end]", "violated"))
    elif isinstance(value, int):
        held[last] = max(1, value + draw.choice((-1, 1)))
    elif value.lstrip("-")[:1].isdigit():
        held[last] = draw.choice((f"{number(value) * 2:.12f}", f"{number(value) / 2:.12f}", value))
    else:
        held[last] = draw.choice(texts)


def everywhere(value):
    if isinstance(value, (dict, list)):
        for entry in value.values() if isinstance(value, dict) else value:
            yield from everywhere(entry)
    else:
        yield value


def shorten(_, certificate, draw):
    """Drops an entry of a list: of the hypotheses, of a tree, of a window, of bounds."""
    lists = [held for held in lists_in(certificate["hypotheses"]) if held]
    held = draw.choice([certificate["hypotheses"], *lists])
    held.pop(draw.randrange(len(held)))


def lists_in(value):
    if isinstance(value, list) and value and not isinstance(value[0], (str, int)):
        yield value
    if isinstance(value, (dict, list)):
        for entry in value.values() if isinstance(value, dict) else value:
            yield from lists_in(entry)


def change_inertia(scenario, _, draw):
    """Of one robot: harmless, or such that its last joint feels no inertia."""
    body = next(iter(draw.choice(scenario["agents"])["robot"].items()))
    limp = draw.random() < 0.5
    if body[0] == "planar_arm":
        half = body[1]["length_m"][0] / 2
        body[1].update(com_m=[half, 0.0 if limp else 0.3], inertia_kg_m2=[0.2, 0.0 if limp else 0.1])
    elif body[0] == "ship":
        inertia = body[1]["inertia"]
        inertia["sway_yaw_kg_m"] = math.sqrt(inertia["sway_kg"] * inertia["yaw_kg_m2"]) * (1.01 if limp else 0.9)


CHANGES = (change_inertia, drop_edge, add_edge, shuffle_edges, change_weight, change_dwell, change_delay, change_root, change_gain, change_leader,
           change_words, reorder_agents, enforce_limits, change_end, spoil, spoil, spoil, spoil, shorten, shorten)


def outcomes(certificate, scenario):
    """(whether all claims are accepted, whether something is rejected), digests aside."""
    found = checker.check(certificate, scenario, SCENARIOS, digests=False)
    claims = [entry for entry in found if entry[2] in (checker.HOLDS, checker.ON_RUN, checker.VIOLATED)]
    rejected = [entry for entry in found if entry[3] == checker.REJECTED]
    return all(entry[3] == checker.ACCEPTED for entry in claims) and not rejected, rejected, found


class Tampering(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = Path(os.environ["FORWARDSTEP_CERTIFICATES"])
        cls.pairs = {}
        for name in NAMES:
            cls.pairs[name] = place_of(name).read_text(), (folder / f"{name}.json").read_text()

    def test_what_was_not_changed_is_accepted_and_true(self):
        for name, (scenario, certificate) in self.pairs.items():
            required = [entry["id"] for entry in json.loads(certificate)["hypotheses"]]
            accepted, _, found = outcomes(certificate, scenario)
            self.assertTrue(accepted, (name, found))
            self.assertTrue(truth(tomllib.loads(scenario), json.loads(certificate), required), name)

    def test_five_hundred_changed_pairs_are_judged_as_the_truth_says(self):
        draw = random.Random(SEED)
        counts, wrong = {True: 0, False: 0}, []
        for case in range(PAIRS):
            name, change = draw.choice(NAMES), CHANGES[case % len(CHANGES)]
            scenario, certificate = tomllib.loads(self.pairs[name][0]), json.loads(self.pairs[name][1])
            required = [entry["id"] for entry in certificate["hypotheses"]]
            before = copy.deepcopy((scenario, certificate))
            change(scenario, certificate, draw)
            expected = truth(scenario, certificate, required)
            accepted, rejected, found = outcomes(json.dumps(certificate), document(scenario))
            said = (case, name, change.__name__, before == (scenario, certificate), expected, found)
            wrong += [said] if accepted != expected or bool(rejected) == expected else []
            counts[expected] += 1
        self.assertEqual(wrong, [])
        self.assertGreater(min(counts.values()), PAIRS // 5, counts)


class FalseProofs(unittest.TestCase):
    """For each guard of the checker a pair that only this guard rejects, at the boundary where there is one."""

    @classmethod
    def setUpClass(cls):
        cls.folder = Path(os.environ["FORWARDSTEP_CERTIFICATES"])

    def judged(self, name, each, spoil_proof, *changes, files=None):
        """The outcome of hypothesis `each` after a change of its entry and of the text of the scenario."""
        text = place_of(name).read_text()
        for old, other in changes:
            self.assertIn(old, text, (name, each))
            text = text.replace(old, other, 1)
        certificate = json.loads((self.folder / f"{name}.json").read_text())
        entry, = [entry for entry in certificate["hypotheses"] if entry["id"] == each][:1]
        spoil_proof(entry)
        found = checker.check(json.dumps(certificate), text, files or place_of(name).parent, digests=False)
        return [(one[3], one[4]) for one in found if one[0] in (each, "certificate")], found

    def rejected(self, name, each, words, spoil_proof=lambda entry: None, *changes):
        judged, found = self.judged(name, each, spoil_proof, *changes)
        self.assertTrue(any(outcome == checker.REJECTED and words in said for outcome, said in judged), (each, words, found))

    def accepted(self, name, each, spoil_proof=lambda entry: None, *changes):
        judged, found = self.judged(name, each, spoil_proof, *changes)
        self.assertEqual([outcome for outcome, _ in judged], [checker.ACCEPTED], (each, found))

    def unchecked(self, name, each, words, spoil_proof=lambda entry: None, *changes):
        judged, found = self.judged(name, each, spoil_proof, *changes)
        self.assertTrue([outcome for outcome, said in judged if words in said] == [checker.UNCHECKED] and len(judged) == 1, (each, found))

    def test_trees(self):
        def steps(*edges):
            return lambda entry: entry["proof"]["windows"][0].update(arborescence=[list(edge) for edge in edges], root="arm-1")

        ring = [(f"arm-{k}", f"arm-{k % 4 + 1}", 1) for k in range(1, 5)]
        self.accepted("theorem-1", "spanning-tree", steps(*ring[:3]))
        # Everybody stands in it, but a cycle hangs in the air: its edges reach each other alone.
        self.rejected("theorem-1", "spanning-tree", "has not been reached", steps(ring[1], ring[2], ring[3]))
        self.rejected("theorem-1", "spanning-tree", "does not reach everybody", steps(*ring[:2]))
        self.rejected("theorem-1", "spanning-tree", "is no edge", steps(*ring[:2], ("arm-2", "arm-4", 1)))
        self.rejected("theorem-1", "spanning-tree", "outside of the window", steps(*ring[:2], ("arm-3", "arm-4", 2)))
        # A root that is not the leader cannot reach him.
        two = ('edges = [["leader", "arm-1"]', 'edges = [["leader", "arm-2"]')
        self.rejected("theorem-8", "leader-reaches-all", "is no edge", lambda entry: None, two)
        self.rejected("theorem-8", "leader-reaches-all", "reach", steps(*ring[:3]))

    def test_windows(self):
        def phases(entry, *numbers):
            entry["proof"]["windows"][0]["phases"] = list(numbers)

        self.rejected("theorem-2", "spanning-tree", "whole periods", lambda entry: phases(entry, 1, 2, 1))
        self.rejected("theorem-2", "spanning-tree", "the phases that follow", lambda entry: phases(entry, 2, 1))
        self.rejected("theorem-2", "spanning-tree", "must be some", lambda entry: entry["proof"].update(windows=[]))
        self.accepted("theorem-2", "spanning-tree", lambda entry: phases(entry, 1, 2, 1, 2))
        # Windows of a period say nothing of phases that are drawn.
        random_ = ("[[network.phases]]", "[network.switching.random]\nseed = 1\ndwell_s = [0.5, 1.0]\n\n[[network.phases]]")
        self.rejected("theorem-2", "spanning-tree", "drawn schedule", lambda entry: None, random_)

    def test_drawn_sequences(self):
        name, each = "theorem-3-24-order-4", "spanning-tree"
        self.rejected(name, each, "allows", lambda entry: entry["proof"]["given"][3].update(until_s="1"))
        self.rejected(name, each, "is no phase", lambda entry: entry["proof"]["given"][3].update(phase=4))
        self.rejected(name, each, "before the run", lambda entry: None, ("end_s = 100", "end_s = 110"))
        self.rejected(name, each, "before the run", lambda entry: entry["proof"]["given"].pop())
        self.rejected(name, each, "is exceeded", lambda entry: entry["proof"].update(longest_s="1.6"))
        # What is left after the last window counts, too.
        self.rejected(name, each, "is exceeded", lambda entry: entry["proof"].update(windows=entry["proof"]["windows"][:2]))
        few = lambda entry: entry["proof"].update(windows=entry["proof"]["windows"][:2], longest_s="100")  # noqa: E731
        self.rejected(name, each, "waits for half of the run", few)
        self.rejected(name, each, "more than the proof shows", lambda entry: entry.update(answer="holds"))

    def test_groups_that_cut(self):
        def groups(*names):
            return lambda entry: entry["proof"].update(groups=[[f"mass-{k}" for k in group] for group in names])

        self.accepted("cut", "spanning-tree", groups((3, 4), (2, 1)))
        self.rejected("cut", "spanning-tree", "not closed", groups((1,), (3, 4)))
        self.rejected("cut", "spanning-tree", "disjoint", groups((1, 2), (1, 2, 3, 4)))
        self.rejected("cut", "spanning-tree", "disjoint", groups((1, 2)))
        self.rejected("cut", "spanning-tree", "must name agents", groups((1, 2), ()))
        self.rejected("cut", "spanning-tree", "not closed", lambda entry: None, ('["mass-3", "mass-4"]]', '["mass-1", "mass-4"]]'))

    def test_dwell_times_and_delays(self):
        self.accepted("theorem-2", "dwell-time", lambda entry: entry["proof"].update(shortest_s="0.7"))
        for least in ("0.70000000000000001", "0", "-1"):
            self.rejected("theorem-2", "dwell-time", "shortest phase", lambda entry: entry["proof"].update(shortest_s=least))
        self.accepted("theorem-2", "bounded-delays", lambda entry: entry["proof"].update(bound_s="1/2"))
        self.rejected("theorem-2", "bounded-delays", "is exceeded", lambda entry: entry["proof"].update(bound_s="0.49999999999999999"))
        # The amplitude counts: 0.3 + 0.25 exceeds a half, of which no other delay here is the reason.
        self.rejected("theorem-2", "bounded-delays", "is exceeded", lambda entry: None, ("mean_s = 0.25", "mean_s = 0.3"))
        swings = ("mean_s = 0.25, amplitude_s = 0.25", "mean_s = 0.2, amplitude_s = 0.3")
        self.rejected("theorem-2", "bounded-delays", "may be negative", lambda entry: None, swings)
        negative = ('"0.2 + 0.1*sin', '"0.2 + 0.3*sin')
        within = lambda entry: entry["proof"].update(bound_s="1", enclosures=[{**entry["proof"]["enclosures"][0], "within": ["-1", "1"]}])  # noqa: E731
        self.rejected("formulas", "bounded-delays", "become negative", within, negative)
        self.rejected("formulas", "bounded-delays", "does not hold", lambda entry: None, negative)
        low = lambda entry: entry["proof"].update(enclosures=[{**entry["proof"]["enclosures"][0], "within": ["-9", "9"]}])  # noqa: E731
        self.rejected("formulas", "bounded-weights", "vanish", low)
        self.rejected("formulas", "bounded-weights", "lacks", lambda entry: entry["proof"].update(enclosures=[]))
        # One piece is too coarse for what 32 show, and a part of the period is not the whole.
        coarse = lambda entry: entry["proof"]["enclosures"][0].update(cells=1)  # noqa: E731
        self.unchecked("formulas", "bounded-weights", "[0, 5], found from t = 0 s on, decides nothing", coarse)
        self.rejected("formulas", "bounded-weights", "does not hold", lambda entry: None, ("1.5*sin(2*t)", "1.8*sin(2*t)"))
        slow = lambda entry: entry["proof"]["enclosures"][0].update(range="period", cells=64)  # noqa: E731
        self.rejected("formulas", "bounded-weights", "does not hold", slow, ("+ 1.5*sin(2*t)", "+ 1.5*sin(2*t/9)"))
        # Below the latency, and an age as large as half of the run, which is bounded by that alone.
        for age in ("0.01", "30.1"):
            older = lambda entry: entry["proof"]["given"][0].update(worst_s=age) or entry["proof"].update(bound_s="60")  # noqa: B023, E731
            self.rejected("six-arms-over-radio", "bounded-delays", "out of range", older)
        # What is heard before a packet arrives is older than a period, which the scenario states.
        for period in (0.6, 5, 30, 1000):
            self.rejected("six-arms-over-radio", "bounded-delays", "out of range", lambda entry: None, ("period_s = 0.02", f"period_s = {period}"))
        self.accepted("six-arms-over-radio", "bounded-delays", lambda entry: None, ("period_s = 0.02", "period_s = 0.03"))
        all_lost = ("loss.bursts = { enter = 0.04, leave = 0.2 }", "loss.random.probability = 1")
        self.rejected("six-arms-over-radio", "bounded-delays", "out of range", lambda entry: None, all_lost)
        self.rejected("six-arms-over-radio", "bounded-delays", "lacks the link", lambda entry: entry["proof"]["given"].pop())
        self.rejected("six-arms-over-radio", "bounded-delays", "more than the proof shows", lambda entry: entry.update(answer="holds"))

    def test_no_draw_of_packets_stays_younger(self):
        """Ages of packets that are drawn here, exactly; and the best draw, which comes as close as can be."""
        draw, tight = random.Random(12), 0
        number_ = lambda most: checker.Fraction(draw.randrange(most + 1), 10)  # noqa: E731
        for case in often(2000):
            period, end_s = number_(60) + checker.Fraction(1, 10), number_(200) + checker.Fraction(1, 10)
            first, latency, jitter = min(number_(60), period), draw.choice((0, number_(30))), number_(20)
            enter = draw.choice((0, 0.3, 1))
            loss = {"bursts": {"enter": enter, "leave": 0.4}} if enter else {"random": {"probability": draw.choice((0.2, 0.9, 1))}}
            (_, body), = loss.items()
            body_ = {"first_s": first, "latency_s": latency, "period_s": period, "jitter_s": jitter, "loss": loss}
            least = checker.least_age(body_, end_s)

            def worst(fate, late):
                bad, arrivals, k = False, [], 0
                while first + k * period <= end_s:
                    bad = fate() < body["probability"] if not enter else fate() < enter if not bad else fate() >= body["leave"]
                    arrivals += [] if bad else [(first + k * period + latency + late() * jitter, first + k * period)]
                    k += 1
                newest, oldest = checker.Fraction(0), checker.Fraction(0)
                for at, sent in sorted(arrivals) + [(end_s, None)]:
                    if at <= end_s and (sent is None or sent >= newest): oldest, newest = max(oldest, at - newest), sent
                return oldest

            for _ in range(5):
                self.assertGreaterEqual(worst(draw.random, lambda: checker.Fraction(draw.randrange(8), 8)), least, (body_, end_s))
            # The best luck: no packet is late, and none is lost; or every other one, where a good link turns bad each time.
            best = worst(lambda: 0 if enter == 1 else 0.999, lambda: 0)
            self.assertEqual(best, least, (body_, end_s))
            tight += best < end_s
        self.assertGreater(tight, len(often(1000)))

    def test_enclosures_that_are_wider_than_what_is_stated_may_be_narrow_enough(self):
        motion = [("motion.sinusoids = [", 'motion.formulas = ["2*t/(1 + t)", "0"]\n#'), ("    { offset = 0.3,", "#"),
                  ("    { offset = -0.2,", "#"), ("\n]", "\n#")]
        zero = {"range": "for-ever", "within": ["0", "0"]}
        # α q̇ + q̈ rises from −2 to 2/27 at t = 2, and falls to zero.
        within = lambda low, high, until_s="1", cells=8: lambda entry: entry.update(answer="holds", proof={"kind": "bounds", "bounds": [  # noqa: E731
            {"range": "tail", "until_s": until_s, "cells": cells, "within": [low, high]}, zero]})
        gain = lambda by: [*motion, ("gain = 2 ", f"gain = {by} ")]  # noqa: E731
        # Where it rises its ends are enough. The first half of a second is enclosed by −3.667, which decides nothing about 2.1.
        self.accepted("theorem-8", "sign-gain", within("-2", "0.0741"), *gain("2.01"))
        self.unchecked("theorem-8", "sign-gain", "decides nothing", within("-2", "0.0741", cells=2), *gain("2.1"))
        # What is stated is not so, though more would be enough; or what is asked for is not.
        self.rejected("theorem-8", "sign-gain", "does not hold [-2, -2], seen at t = 0", within("-1.9", "0.0741"), *gain("2.1"))
        self.rejected("theorem-8", "sign-gain", "does not hold", within("-2", "0.07", "2"), *gain("2.1"))
        self.rejected("theorem-8", "sign-gain", "leaves (-2, 2)", within("-2", "0.0741"), *gain("2"))
        self.rejected("theorem-8", "sign-gain", "does not hold [-2, -2]", within("-1.9", "0.0741"), *gain("1.95"))
        weight = lambda text: ('"2.5 + sin(t) + 1.5*sin(2*t)"', f'"{text}"')  # noqa: E731
        one = lambda low, high, range_="period": lambda entry: entry["proof"]["enclosures"][0].update(  # noqa: E731
            cells=1, range=range_, within=[low, high])
        self.accepted("formulas", "bounded-weights", one("2.5", "7.4"), weight("5 + sin(t) + 1.5*sin(2*t)"))
        self.rejected("formulas", "bounded-weights", "does not hold", one("3.5", "6"), weight("5 + sin(t) + 1.5*sin(2*t)"))
        # Of 2.3 in the middle nobody knows here; and what has no bound is not one.
        self.unchecked("formulas", "bounded-weights", "decides nothing", one("0.1", "4.9"), weight("2.4 + sin(t) + 1.5*sin(2*t)"))
        self.unchecked("formulas", "bounded-weights", "decides nothing", one("1", "1000000", "for-ever"), weight("1 + t"))
        self.rejected("formulas", "bounded-weights", "does not hold", one("1", "200", "for-ever"), weight("1 + t"))
        bound = lambda entry: entry["proof"]["enclosures"][0].update(cells=1, within=["0.1", "0.29"]) or entry["proof"].update(bound_s="0.3")  # noqa: E731
        delay = lambda text: ('"0.2 + 0.1*sin(2*pi*t/3)"', f'"{text}"')  # noqa: E731
        self.accepted("formulas", "bounded-delays", bound, delay("0.2 + 0.05*sin(2*pi*t/3) + 0.05*cos(4*pi*t/3)"))
        self.rejected("formulas", "bounded-delays", "exceed the bound", lambda entry: entry["proof"].update(bound_s="0.29"))

    def test_a_weight_may_be_a_constant_by_a_formula(self):
        constant = ('"2.5 + sin(t) + 1.5*sin(2*t)"', '"0.3 + 0*t"')
        self.accepted("formulas", "bounded-weights", lambda entry: None, constant)
        vanishes = lambda entry: entry.update(answer="violated", proof={"kind": "limit", "edge": ["mass-1", "mass-2", 1]})  # noqa: E731
        self.rejected("formulas", "bounded-weights", "must be a text", vanishes, constant)

    def test_no_piece_shows_nothing(self):
        none = lambda entry: entry["proof"]["enclosures"][0].update(cells=0, within=["1", "2"])  # noqa: E731
        self.rejected("formulas", "bounded-weights", "must be some", none)
        one_end = lambda entry: entry["proof"]["enclosures"][0].update(within=["0", "9", "1"])  # noqa: E731
        self.rejected("formulas", "bounded-weights", "must have two ends", one_end)

    def test_times_at_which_a_weight_or_a_delay_is_too_small(self):
        at = lambda t_s: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "below", "t_s": t_s, "edge": ["mass-1", "mass-2", 1]})
        weight = lambda text: ('"2.5 + sin(t) + 1.5*sin(2*t)"', f'"{text}"')  # noqa: E731
        delay = lambda text: ('"0.2 + 0.1*sin(2*pi*t/3)"', f'"{text}"')  # noqa: E731
        self.accepted("formulas", "bounded-weights", at("2"), weight("1 - t"))
        self.accepted("formulas", "bounded-delays", at("2"), delay("1 - t"))
        # Where it is positive, and before the start.
        self.rejected("formulas", "bounded-weights", "no such time", at("1"))
        self.rejected("formulas", "bounded-delays", "no such time", at("1"))
        self.rejected("formulas", "bounded-weights", "before the start", at("-2"), weight("1 + t"))
        self.rejected("formulas", "bounded-delays", "before the start", at("-2"), delay("1 + t"))
        # Zero, or next to it on either side, as far as enclosures tell.
        self.unchecked("formulas", "bounded-weights", "no such time", at("1/3"), weight("0.5 - cos(pi*t)"))
        # A weight of zero is none, a delay of zero is one.
        self.accepted("formulas", "bounded-weights", at("0"), weight("t"))
        self.rejected("formulas", "bounded-delays", "no such time", at("0"), delay("t"))

    def test_what_becomes_of_a_weight_or_a_delay_in_the_end(self):
        ends = lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "limit", "edge": ["mass-1", "mass-2", 1]})
        weight = lambda text: ('"2.5 + sin(t) + 1.5*sin(2*t)"', f'"{text}"')  # noqa: E731
        delay = lambda text: ('"0.2 + 0.1*sin(2*pi*t/3)"', f'"{text}"')  # noqa: E731
        for text in ("exp(-t)", "1/(1 + t)", "2 - t/(1 + t)*3", "1 + t", "sqrt(1 + t)/(1 + t)", "1 - t/sqrt(1 + t^2)", "t/sqrt(1 + t)"):
            self.accepted("formulas", "bounded-weights", ends, weight(text))
        for text in ("0.5 + exp(-t)", "t/(1 + t)", "sqrt(2 + (t - 3)^2)/(1 + t)"):
            self.rejected("formulas", "bounded-weights", "stays near", ends, weight(text))
        # It comes below zero again and again, which its limit points do not tell here.
        self.unchecked("formulas", "bounded-weights", "stays near", ends, weight("0.5 + sin(t)"))
        # A delay may come to zero, and not below.
        self.accepted("formulas", "bounded-delays", ends, delay("2 - t/(1 + t)*3"))
        for text in ("exp(-t)", "1/(1 + t)", "0.5 + exp(-t)"):
            self.rejected("formulas", "bounded-delays", "stays near", ends, delay(text))

    def test_links_that_lose_every_packet(self):
        # Of the last phase, which stays.
        in_phase = lambda phase: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "loses-all", "edge": ["mass-1", "mass-2", phase]})
        loses = in_phase(3)
        link = lambda loss: ('delay.formula_s = "0.2 + 0.1*sin(2*pi*t/3)"',  # noqa: E731
                             f"delay.packets = {{ period_s = 0.25, latency_s = 0.08, seed = 41{loss} }}")
        self.accepted("formulas", "bounded-delays", loses, link(", loss.random = { probability = 1 }"))
        self.rejected("formulas", "bounded-delays", "does not lose", in_phase(1), link(", loss.random = { probability = 1 }"))
        for loss in ("", ", loss.random = { probability = 0.5 }", ", loss.bursts = { enter = 1, leave = 0.1 }",
                     ", loss.random = { probability = 1, most_consecutive = 3 }"):
            self.rejected("formulas", "bounded-delays", "does not lose every packet", loses, link(loss))
        self.rejected("formulas", "bounded-delays", "does not lose every packet", loses)

    def test_groups_that_a_leader_does_not_reach(self):
        def groups(*stated):
            return lambda entry: entry.update(answer="violated", proof={"kind": "cut", "groups": [list(group) for group in stated]})

        arms, gone = [f"arm-{k}" for k in range(1, 5)], ('["leader", "arm-1"], ', "")
        self.accepted("theorem-8", "leader-reaches-all", groups(arms), gone)
        # The leader hears nobody anyway, and with him everybody is a group.
        for stated in ([["leader"]], [["leader", *arms]]):
            self.rejected("theorem-8", "leader-reaches-all", "without the leader", groups(*stated))
        self.rejected("theorem-8", "leader-reaches-all", "without the leader", groups(arms, ["leader"]), gone)

    def test_numbers(self):
        self.rejected("theorem-2", "real-roots", "below all roots", lambda entry: entry["proof"].update(value="1.0000000000000001"))
        self.rejected("theorem-2", "real-roots", "positive bound", lambda entry: entry["proof"].update(value="0"))
        self.rejected("theorem-2", "common-order", "order of all", lambda entry: entry["proof"].update(value=3))
        self.rejected("remark-4", "manipulability", "largest gain", lambda entry: entry["proof"].update(value="3.9"))
        self.rejected("gusts", "pushes-end", "before the end", lambda entry: entry["proof"].update(value="20.1999"))
        self.rejected("gusts", "pushes-end", "before the end", lambda entry: None, ("for_s = 0.2", ""))
        self.rejected("saturated-coupling", "coupling-sector", "that of the scenario", lambda entry: None, ("saturated = 0.4", "saturated = 0.5"))
        self.rejected("saturated-coupling", "coupling-sector", "that of the scenario", lambda entry: entry["proof"].update(form="tanh"))

    def test_classes(self):
        name, each = "theorem-3-a5-order-3", "common-first-root"
        own = ("roots_per_s = [1.0, 3.0, 5.0]", "roots_per_s = [1.5, 3.0, 5.0]")
        self.rejected(name, each, "κ₀ differ", lambda entry: None, own)
        apart = [[f"arm-{k}" for k in range(1, 5)], ["quick-arm-1", "quick-arm-2"]]
        self.rejected(name, each, "an edge leads back", lambda entry: entry["proof"].update(classes=apart), own)
        self.rejected(name, each, "every agent", lambda entry: entry["proof"]["classes"][0].pop())
        self.rejected("theorem-2", each, "is not so", lambda entry: entry.update(proof={"kind": "constant"}))
        self.accepted("first-order", each, lambda entry: entry.update(proof={"kind": "constant"}))

    def test_gains(self):
        name, each, matrix = "formulas", "positive-gains", "[[6, 1], [1, 4]]"

        def pivots(*numbers):
            def spoil_all(entry):
                for one in entry["proof"]["matrices"]:
                    one["pivots"] = list(numbers)
            return spoil_all

        self.accepted(name, each, pivots("6", "23/6"))
        self.rejected(name, each, "are not positive pivots", pivots("6", "4"))
        # Of a larger matrix they are less than the pivots, as they are allowed to be; none may be missing.
        self.accepted(name, each, pivots("6", "23/6"), (matrix, "[[7, 1], [1, 4]]"))
        self.rejected(name, each, "are not positive pivots", pivots("6", "23/6"), (matrix, "[[6, 1], [1, 3.9]]"))
        self.rejected(name, each, "are not positive pivots", pivots("6"))
        self.rejected(name, each, "are not positive pivots", pivots("6", "0"))
        # Singular, and as the pivots say; and symmetric only in its lower half.
        self.rejected(name, each, "are not positive pivots", pivots("4", "0"), (matrix, "[[4, 2], [2, 1]]"))
        self.rejected(name, each, "symmetric", pivots("6", "23/6"), (matrix, "[[6, 0.5], [2, 4]]"))
        self.rejected(name, each, "lacks `damping`", lambda entry: entry["proof"].update(matrices=[]))
        self.rejected("theorem-2", each, "is not positive", lambda entry: None, ("damping.gain = 8", "damping.gain = 0"))
        self.rejected("theorem-2", each, "is not positive", lambda entry: None, ("damping.gain = 8", "damping.gain = [8, -1]"))
        self.rejected("six-arms", each, "is not positive", lambda entry: None, ("damping.bandwidth_per_s = 20", "damping.bandwidth_per_s = -20"))
        self.rejected("double-integrators", "position-only-gains", "wrong mass", lambda entry: None, ("adaptation_gain = 10", "adaptation_gain = 0"))
        true = (("adaptation_gain = 8 ", "adaptation_gain = 0 "), ("estimate_start_kg = 0", "estimate_start_kg = 2"))
        self.accepted("without-velocity", "position-only-gains", lambda entry: None, *true)
        self.rejected("without-velocity", "position-only-gains", "wrong mass", lambda entry: None, true[0])
        name, each, known = "model-reference", "model-reference-gains", "adaptation_gain = 0\nestimate_start_kg = 2"
        for gain in ("filter_per_s = 20", "adaptation_gain = 8"):
            self.rejected(name, each, "is not positive", lambda entry: None, (gain, gain.split(" =")[0] + " = -1"))
        self.accepted(name, each, lambda entry: None, ("adaptation_gain = 8", known))
        self.rejected(name, each, "wrong mass", lambda entry: None, ("adaptation_gain = 8", known.replace("2", "1")))
        self.rejected(name, each, "wrong mass", lambda entry: None, ("adaptation_gain = 8", "adaptation_gain = 0"))
        self.rejected("swarm-tracking", "swarm-coupling", "are not", lambda entry: None, ("coupling = 12", "coupling = 11"))
        at_zero = ("roots_per_s = [1.0, 1.0]", "roots_per_s = [0.0, 2.0]")
        self.rejected("swarm-tracking", "swarm-coupling", "is for real roots", lambda entry: None, at_zero)

    def test_roots_of_a_polynomial_of_order_two(self):
        """p² + β p + α: rounded to the side on which more is asked for."""
        found = lambda **body: [tuple(float(x) for x in root) for root in checker.roots_of(body)]  # noqa: E731
        self.assertEqual(found(alpha=3), [(3, 0)])
        self.assertEqual(found(alpha=2, beta=3), [(1, 0), (2, 0)])
        self.assertEqual(found(alpha=5, beta=2), [(1, 2), (1, 2)])
        for alpha, beta in ((1, 3), (2, 5), (7, 2), (1, 1)):
            (a, b), (c, _) = roots = checker.roots_of({"alpha": alpha, "beta": beta})
            # Of two real roots the smaller is no larger than it is, of a pair the imaginary part no smaller.
            self.assertTrue((alpha - beta * a + a * a >= 0 and 2 * a <= beta == a + c) if b == 0 else a * a + b * b >= alpha, roots)

    def test_terms_have_a_value_everywhere_one_and_all(self):
        for text in ("log(x)", "1/x", "sqrt(x - 1)"):
            judged, found = self.judged("desired-target", "defined-terms", lambda entry: None, ('"2 + cos(x)"', f'"{text}"'))
            self.assertEqual([outcome for outcome, _ in judged], [checker.UNCHECKED], found)

    def test_a_target_has_as_many_bounded_derivatives_as_those_who_follow_it_have_roots(self):
        for law, roots, least in (("adaptive", [1], 2), ("adaptive", [1, 2], 2), ("adaptive", [1, 2, 3], 3), ("linearising", [1], 1), ("linearising", [1, 2, 3], 3)):
            agent = type("Agent", (), {"law": law, "roots": roots, "gains": {}})
            self.assertEqual(checker.needed(agent, None), least, (law, roots))

    def test_joints_need_inertia(self):
        robot = (HERE.parent / "crates" / "io" / "robots" / "ur5e.urdf").read_text()
        scenario = checker.Scenario(place_of("six-arms").read_text(), SCENARIOS)
        agent = scenario.agents[0]
        scenario.text_of = lambda _: robot
        self.assertTrue(checker.solid(scenario, agent))
        scenario.text_of = lambda _: checker.re.sub(r'i(xx|yy|zz)="[^"]*"', r'i\1="0"', robot)
        self.assertFalse(checker.solid(scenario, agent))
        # The last link without a body, and one before it with a mass alone.
        bodies = [match.span() for match in checker.re.finditer(r"<inertial>.*?</inertial>", robot, checker.re.DOTALL)]
        scenario.text_of = lambda _: robot[:bodies[-1][0]] + robot[bodies[-1][1]:]
        self.assertFalse(checker.solid(scenario, agent))
        scenario.text_of = lambda _: robot[:bodies[-2][0]] + robot[bodies[-2][1]:]
        self.assertRaises(checker.Undecided, checker.solid, scenario, agent)
        scenario.text_of = lambda _: robot.replace('mass value="', 'mass value="-', 1)
        self.assertFalse(checker.solid(scenario, agent))
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "ur5e.urdf").write_text(checker.re.sub(r'i(xx|yy|zz)="[^"]*"', r'i\1="0"', robot))
            certificate = (self.folder / "six-arms.json").read_text()
            found = checker.check(certificate, place_of("six-arms").read_text(), Path(folder), digests=False)
            words = [one[4] for one in found if one[3] == checker.REJECTED]
            self.assertEqual(words, ["is not so by the text", "arm-1 may have a joint without inertia"])
        scenario.text_of = lambda _: "<robot><link/></robot"
        self.assertRaises(checker.Undecided, checker.solid, scenario, agent)

    def judged_robot(self, of, *joints, body='<mass value="1"/><inertia ixx="1" iyy="1" izz="1"/>', last=None, **of_body):
        """What `of` says of links a, b, … with joints (kind, axis, rpy) between them; None where it is undecided."""
        scenario = checker.Scenario(place_of("six-arms").read_text(), SCENARIOS)
        links = [f'<link name="{name}"><inertial>{body}</inertial></link>' for name in "abcdef"[:len(joints) + 1]]
        links[-1] = links[-1].replace(body, last or body)
        between = [f'<joint name="{k}" type="{kind}"><parent link="{"abcdef"[k]}"/><child link="{"abcdef"[k + 1]}"/>'
                   f'<origin xyz="1 0 0" rpy="{rpy}"/><axis xyz="{axis}"/></joint>' for k, (kind, axis, rpy) in enumerate(joints)]
        scenario.text_of = lambda _: f'<robot>{"".join(links + between)}</robot>'
        scenario.agents[0].body = {"file": "", **of_body}
        try:
            return of(scenario, scenario.agents[0])
        except checker.Undecided:
            return None

    def test_what_slides_keeps_to_the_axes_that_turn_it_or_is_undecided(self):
        still, quarter = "0 0 0", "0 0 1.57"
        x, z, back = "1 0 0", "0 0 1", "0 0 -2"
        turn, slide, fixed = ("revolute", z, still), ("prismatic", z, still), ("fixed", x, still)
        for joints, expected in (((slide, turn), True), ((slide, slide), True), ((fixed, slide), True), ((turn, slide), True),
                                 ((turn, ("prismatic", back, still)), True), ((("continuous", x, still), slide), None),
                                 ((turn, ("prismatic", z, quarter)), True), ((turn, ("prismatic", z, "0.1 0 0")), None),
                                 ((turn, ("fixed", x, "0 0.1 0"), slide), None), ((turn, ("fixed", x, quarter), slide), True),
                                 ((("revolute", x, still), turn, slide), None), ((turn, turn, slide, turn), True),
                                 ((turn, ("revolute", x, still), ("fixed", x, still), ("prismatic", x, still)), None),
                                 # Turned aside and back: the same direction at some posture only.
                                 ((turn, ("revolute", x, still), turn, slide), None), ((("fixed", x, "1 2 3"), turn, slide), True)):
            self.assertEqual(self.judged_robot(checker.unturned, *joints), expected, joints)
            self.assertTrue(self.judged_robot(checker.solid, *joints), joints)
        # A locked joint turns nothing, but may turn aside what is turned before it.
        aside = (turn, ("revolute", x, still), slide)
        self.assertTrue(self.judged_robot(checker.unturned, *aside[1:], locked={"0": 0}))
        self.assertIsNone(self.judged_robot(checker.unturned, *aside, locked={"1": 0}))
        self.assertTrue(self.judged_robot(checker.unturned, *aside, locked={"0": 0, "1": 0}))
        # What is no axis is parallel to nothing.
        self.assertRaises(checker.Meaningless, self.judged_robot, checker.unturned, ("revolute", "0 0 0", still), slide)
        self.assertIsNone(self.judged_robot(checker.unturned, ("revolute", "0 0 1 0", still), slide))

    def test_a_mass_beside_an_axis_is_felt(self):
        still, z = "0 0 0", "0 0 1"
        turn, slide = ("revolute", z, still), ("prismatic", z, still)
        point = lambda centre, mass=1: f'<origin xyz="{centre}"/><mass value="{mass}"/><inertia ixx="0" iyy="0" izz="0"/>'  # noqa: E731
        for joints, last, expected in (((turn, turn), point("0.2 0 0"), True), ((turn, turn), point("0 0 0.2"), False),
                                       ((turn, turn), point("0.2 0 0", 0), False), ((turn, slide), point("0 0 0.2"), True),
                                       ((turn, ("fixed", z, still)), point("0.2 0 0"), True),
                                       # What a turn carries aside as it slides has no bound by compactness.
                                       ((("revolute", "1 0 0", still), slide), point("0.2 0 0"), None),
                                       ((turn, turn), '<mass value="0"/><inertia ixx="1" iyy="1" izz="1"/>', True),
                                       ((turn, slide), '<mass value="0"/><inertia ixx="1" iyy="1" izz="1"/>', None),
                                       # Masses and inertias below zero may take away what others give.
                                       ((turn, turn), '<origin xyz="1 0 0"/><mass value="1"/><inertia ixx="-0.1" iyy="1" izz="1"/>', None),
                                       ((turn, turn), '<mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="2"/>', None)):
            self.assertEqual(self.judged_robot(checker.solid, *joints, last=last), expected, (joints, last))
        # An inertia about some axes: about that of the joint, not about it, and about one that is not looked at.
        rod = lambda turned=still, more="": f'<origin xyz="0 0 1" rpy="{turned}"/><mass value="1"/><inertia ixx="0" iyy="0" izz="0.1"{more}/>'  # noqa: E731
        across = "revolute", "1 0 0", still
        for joint, last, expected in ((turn, rod(), True), (("revolute", "1 1 1", still), rod(), True), (turn, rod("0.1 0 0"), None),
                                      (across, rod().replace("0 0 1", "1 0 0"), False), (across, rod(), True),
                                      # Of what no body has nothing is said: a negative inertia about x + y, or about z.
                                      (turn, rod(more=' ixy="-1"'), None), (turn, rod().replace("0.1", "-0.1"), None)):
            self.assertIs(self.judged_robot(checker.solid, turn, joint, last=last), expected, (joint, last))
        self.assertTrue(self.judged_robot(checker.solid, turn, turn, body=rod()))
        self.assertIsNone(self.judged_robot(checker.solid, slide, turn, body=rod(), last=rod("0.1 0 0")))
        self.assertEqual(checker.pivots([[0, 0, 0], [0, 2, 1], [0, 1, 3]]), [0, 2, checker.Fraction(5, 2)])
        self.assertEqual(checker.pivots([[0, 0, 1], [0, 2, 1], [1, 1, 3]]), [0])
        self.assertTrue(self.judged_robot(checker.solid, turn, turn, body=point("0.2 0 0")))
        self.assertIs(self.judged_robot(checker.solid, turn, turn, body=point("0.2 0 0"), last=point("0 0 1")), False)
        # With something that is fixed to it, whose centre is not looked at, such a point may be beside.
        self.assertIsNone(self.judged_robot(checker.solid, turn, turn, ("fixed", z, still), last=point("0 0 1"), body=point("0 0 1")))

    def test_motions(self):
        self.rejected("theorem-8", "sign-gain", "leaves", lambda entry: None, ("gain = 2 ", "gain = 0.5 "))
        self.rejected("theorem-8", "sign-gain", "does not hold", lambda entry: None, ("amplitude = 0.6", "amplitude = 1.2"))
        self.rejected("theorem-8", "sign-gain", "for each axis", lambda entry: entry["proof"]["bounds"].pop())
        instant = lambda t_s: lambda entry: entry.update(answer="violated", proof={"kind": "instant", "t_s": t_s, "axis": 1})  # noqa: E731
        small = ("gain = 2 ", "gain = 0.6 ")
        # α q̇ + q̈ of 0.6 sin 0.8 t is 0.48 cos 0.8 t − 0.384 sin 0.8 t, at most 0.614.
        self.accepted("theorem-8", "sign-gain", instant("7.0"), small)
        self.rejected("theorem-8", "sign-gain", "is no time", instant("0"), small)
        self.rejected("theorem-8", "sign-gain", "before the start", instant("-1"), small)
        for axis in (0, 3):
            of_none = lambda entry: entry.update(answer="violated", proof={"kind": "instant", "t_s": "7", "axis": axis})  # noqa: E731, B023
            self.rejected("theorem-8", "sign-gain", "is of no axis", of_none, small)
        self.rejected("theorem-8", "sign-gain", "is no time", instant("47"), small)
        self.rejected("theorem-8", "bounded-leader", "too low", lambda entry: entry["proof"].update(order=2))
        self.rejected("formation", "bounded-target", "does not bound", lambda entry: None, ("0.2*t + cos(0.3*t)", "0.2*t^2 + cos(0.3*t)"))
        zero = ("target.formulas = [0, 0, 0, 1] ", "target.formulas = [0, 0, 0, \"sin(t)\"] ")
        away = lambda entry: entry["proof"]["bound"].update(within=["-1", "1"])  # noqa: E731
        self.rejected("theorem-7", "nonzero-quaternion", "holds zero", away, zero)
        norm = lambda entry: entry.update(proof={"kind": "norm", "bound": {"range": "for-ever", "within": ["0", "1"]}})  # noqa: E731
        self.rejected("theorem-7", "nonzero-quaternion", "leaves (0, inf)", norm, zero)
        centre = ('["0.8 + 0.3*cos(t)", "0.6 + 0.3*sin(t)"]', '["0.1 + 0*t", "0"]')
        inner = lambda entry: entry["proof"]["bound"].update(within=["0.01", "0.01"])  # noqa: E731
        self.rejected("theorem-6", "target-within-reach", "leaves (1/25, 81/25)", inner, centre)
        for within in (["-2", "1"], ["-1", "2"]):
            self.rejected("theorem-8", "sign-gain", "leaves", lambda entry: entry["proof"]["bounds"][0].update(within=within))  # noqa: B023
        by_entry = lambda number, *within: lambda entry: entry.update(  # noqa: E731
            proof={"kind": "entry-away", "entry": number, "bound": {"range": "for-ever", "within": list(within)}})
        self.accepted("theorem-7", "nonzero-quaternion", by_entry(1, "-3", "-2"), ("[0, 0, 0, 1] ", "[-2, 0, 0, 0] "))
        touches = ("[0, 0, 0, 1] ", '[0, 0, 0, "1 - cos(t)"] ')
        for within in (("0", "2"), ("-2", "0")):
            self.rejected("theorem-7", "nonzero-quaternion", "holds zero", by_entry(4, *within), (
                touches if within[0] == "0" else (touches[0], touches[1].replace("1 - cos(t)", "cos(t) - 1"))))
        for number in (0, 5):
            entry_ = {"kind": "entry-away", "entry": number, "bound": {"range": "for-ever", "within": ["1", "1"]}}
            self.rejected("theorem-7", "nonzero-quaternion", "is no entry", lambda entry: entry.update(proof=entry_))  # noqa: B023
        self.rejected("theorem-7", "nonzero-quaternion", "does not hold", lambda entry: None, zero)
        self.rejected("theorem-7", "known-momentum", "by the text", lambda entry: None, (
            "[goal]", '[[external_wrenches]]\non = ["craft"]\nby.body_torque_n_m = [1, 0, 0]\n[goal]'))

    def test_curves_through_points(self):
        self.rejected("remark-12", "sign-gain", "leaves", lambda entry: None, ("gain = 2 ", "gain = 0.4 "))
        self.rejected("remark-12", "sign-gain", "does not hold", lambda entry: None, ("[0.8, -0.4]", "[1.6, -0.4]"))
        self.rejected("remark-12", "sign-gain", "does not hold", lambda entry: None, ("times_s = [2, 6,", "times_s = [2, 3,"))
        instant = lambda t_s: lambda entry: entry.update(answer="violated", proof={"kind": "instant", "t_s": t_s, "axis": 1})  # noqa: E731
        self.rejected("remark-12", "sign-gain", "is no time", instant("1"), ("gain = 2 ", "gain = 0.1 "))
        self.accepted("remark-12", "sign-gain", instant("3"), ("gain = 2 ", "gain = 0.1 "))
        # Where the third derivative jumps both sides count.
        self.unchecked("remark-12", "sign-gain", "is no time", instant("2"), ("gain = 2 ", "gain = 0.1 "))
        # A quaternion that vanishes at a point, and one that does between two.
        for row in ("[0, 0, 0, 0]", "[0, 0, 0, -1]"):
            wide = lambda entry: entry["proof"]["bound"].update(within=["-9", "9"])  # noqa: E731
            self.rejected("rest-to-rest", "nonzero-quaternion", "does not hold", lambda entry: None, ("[0, 0, 0, 1]", row))
            self.rejected("rest-to-rest", "nonzero-quaternion", "holds zero", wide, ("[0, 0, 0, 1]", row))
        name, certificate = "attitude-from-a-table", (self.folder / "attitude-from-a-table.json").read_text()
        rows = (SCENARIOS / "overflight.csv").read_text()
        for row, outcome in (("20,0.136512,-0.402270,0.060797,0.903242", checker.ACCEPTED), ("20,0,0,0,0", checker.REJECTED)):
            with tempfile.TemporaryDirectory() as folder:
                old, = [line for line in rows.splitlines() if line.startswith("20,")]
                (Path(folder) / "overflight.csv").write_text(rows.replace(old, old if outcome == checker.ACCEPTED else row))
                found = checker.check(certificate, place_of(name).read_text(), Path(folder), digests=False)
                self.assertEqual([one[3] for one in found if one[0] == "nonzero-quaternion"], [outcome], found)

    def test_reach_of_a_tip(self):
        name, each = "task-space-ur5e", "target-within-reach"
        wide = lambda entry: entry["proof"]["bound"].update(within=["0", "99"])  # noqa: E731
        far = ("-0.60 + 0.08", "-1.60 + 0.08")
        self.rejected(name, each, "does not hold", lambda entry: None, far)
        self.rejected(name, each, "leaves", wide, far)
        out = lambda t_s: lambda entry: entry.update(answer="violated", proof={"kind": "out-of-reach", "t_s": t_s})  # noqa: E731
        self.accepted(name, each, out("2"), far)
        self.rejected(name, each, "is no time", out("2"))
        self.rejected(name, each, "before the start", out("-2"), far)
        robot = (HERE.parent / "crates" / "io" / "robots" / "ur5e.urdf").read_text()
        certificate = (self.folder / f"{name}.json").read_text()
        # Without its forearm it gets to 0.425 m and what the wrist adds; a joint that slides, or is locked aslant, is not known.
        for old, new, outcome in (("-0.3922 0 0", "-0.3922 0 0", checker.ACCEPTED), ("-0.3922 0 0", "0 0 0", checker.REJECTED),
                                  ('elbow_joint" type="revolute"', 'elbow_joint" type="prismatic"', checker.UNCHECKED)):
            self.assertIn(old, robot)
            with tempfile.TemporaryDirectory() as folder:
                (Path(folder) / "ur5e.urdf").write_text(robot.replace(old, new, 1))
                found = checker.check(certificate, place_of(name).read_text(), Path(folder), digests=False)
                self.assertEqual([one[3] for one in found if one[0] == each], [outcome], found)

    def test_formulas_are_not_enclosed_up_to_the_end_of_a_run_alone(self):
        run = {"range": "run", "cells": 8}
        bounds = lambda entry: entry.update(answer="holds on [0, end]", proof={"kind": "bounds", "bounds": [  # noqa: E731
            {**run, "within": ["0", "1"]}, {**run, "within": ["0", "0"]}]})
        motion = [("motion.sinusoids = [", 'motion.formulas = ["0.01*t^2", "0"]\n#'), ("    { offset = 0.3,", "#"),
                  ("    { offset = -0.2,", "#"), ("\n]", "\n#")]
        self.rejected("theorem-8", "sign-gain", "is of no known kind", bounds, *motion)

    def test_a_sign_is_held_no_longer_than_the_leader_lets_it(self):
        name, each = "theorem-8", "set-valued-sign"
        self.accepted(name, each)
        # h κ is 0.005, and ξ̇₀ 120 times as large as what κ makes of the motion.
        slow = ("roots_per_s = [1.0]", "roots_per_s = [0.01]\nsign_period_s = 0.5")
        self.unchecked(name, each, "not small beside what the leader moves", lambda entry: None, slow)
        self.rejected(name, each, "is not so by the text", lambda entry: None, (slow[0], slow[1].replace("0.5", "40")))
        # What stands still leaves nothing.
        still = [("motion.sinusoids = [", 'motion.formulas = ["1", "0"]\n#'), ("    { offset = 0.3,", "#"),
                 ("    { offset = -0.2,", "#"), ("\n]", "\n#")]
        self.accepted(name, each, lambda entry: None, slow, *still)

    def test_a_chain_runs_under_the_law_that_the_program_takes(self):
        self.assertEqual((checker.USUAL_LAW["chain"], checker.USUAL_LAW["vector_chain"]), ("linear_adaptive",) * 2)

    def test_lengths_that_vary_reach_as_far_as_all_of_them_do(self):
        name, each, count = "theorem-6", "target-within-reach", 'name = "arm"'
        varied = lambda share: (count, f"{count}\nparameter_variation = {{ seed = 1, relative = {share} }}")  # noqa: E731
        # The target keeps between 0.7 and 1.3 m, the arm reaches from 0.2 to 1.8 m with lengths of 1 and 0.8 m.
        self.accepted(name, each, lambda entry: None, varied("0.2"))
        self.unchecked(name, each, "lengths vary", lambda entry: None, varied("0.3"))
        out = lambda entry: entry.update(answer="violated", proof={"kind": "out-of-reach", "t_s": "0"})  # noqa: E731
        old = '["0.8 + 0.3*cos(t)", "0.6 + 0.3*sin(t)"]'
        for place, outcome in (("2.0", checker.ACCEPTED), ("1.9", checker.UNCHECKED), ("1.5", checker.REJECTED)):
            judged, found = self.judged(name, each, out, varied("0.1"), (old, f'["{place}", "0"]'))
            self.assertEqual([outcome_ for outcome_, _ in judged], [outcome], (place, found))

    def test_a_tip_is_no_nearer_than_the_longest_length_leaves_it(self):
        name, each = "pose-ur5e", "target-within-reach"
        far = [("at_m = [0, 0, 0.15]", "at_m = [0, 3, 0.15]"), ("kinematic_start.given = [0, 0, 0.1]", "kinematic_start.given = [0, 3, 0.1]")]
        self.rejected(name, each, "leaves (3.2", lambda entry: None, *far)
        self.accepted(name, each, lambda entry: entry.update(answer="violated", proof={"kind": "out-of-reach", "t_s": "0"}), *far)
        # What is reached along two axes is another.
        scenario = checker.Scenario(place_of(name).read_text(), SCENARIOS)
        agent = scenario.agents[0]
        agent.gains["end_effector"]["coordinates"] = "xy"
        self.assertRaises(checker.Undecided, checker.outstretched, scenario, agent)

    def test_numbers_are_those_that_run_and_files_may_begin_with_a_mark(self):
        self.assertEqual(checker.exact(2**53 + 1, "x"), 2**53)
        self.assertEqual(checker.constant_for_ever(checker.formula("1/3")), checker.decimal(repr(1 / 3)))
        self.assertEqual(checker.constant_for_ever(checker.formula("1/3 + 0*t")), checker.decimal(repr(1 / 3)))
        with tempfile.TemporaryDirectory() as folder:
            (Path(folder) / "own.csv").write_bytes(b"\xef\xbb\xbffrom,to")
            self.assertEqual(checker.read(Path(folder) / "own.csv")[1], "from,to")

    def test_waves_of_one_angle_add_up_as_vectors_whatever_they_are_multiplied_with(self):
        for text, most in (("sin(t) - cos(t)", 2**0.5), ("3*sin(t) + 4*cos(t)", 5), ("sin(t)*t/(1 + t) - cos(t)", 2**0.5),
                           ("cos(t)*tanh(t) - sin(t)*(1 + 1/t)", 5**0.5), ("sin(t)*sin(t) + 2*cos(t)*cos(t)", 5**0.5)):
            low, high = checker.enclose(checker.formula(text), checker.LATE)
            self.assertTrue(most - 1e-9 < high < most + 1e-3 and -most - 1e-3 < low <= 1e-9, (text, float(low), float(high)))
        # What grows and is taken away again goes nowhere, and nowhere is not beyond every bound.
        self.assertFalse(checker.endless(checker.formula("t*sin(t) - t*sin(t)")))
        self.assertTrue(checker.endless(checker.formula("t*(2 + sin(t))")) and checker.endless(checker.formula("-t")))

    def test_a_slope_of_one_sign_leaves_what_is_between_the_ends(self):
        of = lambda text, low, high: checker.straight(checker.formula(text), (checker.Fraction(low), checker.Fraction(high)))  # noqa: E731
        self.assertEqual((of("t^2 - t", 1, 2), of("t - t^2", 1, 2)), ((0, 2), (-2, 0)))
        low, high = of("t^2 - t", 0, 1)
        self.assertTrue(low <= checker.Fraction(-1, 4) and high >= 0)

    def test_a_push_has_a_bounded_value_until_it_ends(self):
        name, each, old = "gusts", "pushes-end", '"2 + sin(3*t)"'
        self.accepted(name, each)
        for force, outcome in (("1/(t - 9)", checker.ACCEPTED), ("1/(t - 12)", checker.UNCHECKED), ("1/(t - 16)", checker.UNCHECKED),
                               ("log(12 - t)", checker.UNCHECKED), ("1/(17 - t)", checker.ACCEPTED)):
            judged, found = self.judged(name, each, lambda entry: None, (old, f'"{force}"'))
            self.assertEqual([outcome_ for outcome_, _ in judged], [outcome], (force, found))
        # One that has come to zero before it begins does nothing.
        late = lambda entry: entry["proof"].update(value="20.3")  # noqa: E731
        self.accepted(name, each, late, (f"[{old}, 1, 0]", '["max(0, 8 - t)", 0, 0]'), ("for_s = 6\n", ""))

    def test_a_robot_may_travel_where_its_dynamics_are_bounded_wherever_it_is(self):
        name, each = "through-waypoints", "bounded-target"
        text = place_of(name).read_text()
        points = text[text.index("[agents.target.points]"):text.index("[reference.tracking]")]
        by = lambda path: (points, f'target.formulas = ["{path}", "0", "0", "0", "0", "0"]\n')  # noqa: E731
        holds = lambda entry: entry.update(answer="holds", proof={"kind": "derivatives", "order": 2, "stretch": {"range": "for-ever"}})  # noqa: E731
        grows = lambda order: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "diverges", "motion": 1, "axis": 1, "order": order})
        self.accepted(name, each, holds, by("t + sin(t)"))
        self.rejected(name, each, "no derivative that a law uses", grows(0), by("t + sin(t)"))
        self.rejected(name, each, "does not bound derivative 1", holds, by("t^2"))
        self.accepted(name, each, grows(1), by("t^2"))
        # The proof of a law that measures no velocity asks for more.
        self.rejected("without-velocity", each, "does not bound derivative 0", lambda entry: None, ('["sin(t)"', '["t + sin(t)"'))

    def test_a_torque_whose_square_has_an_integral_need_not_end(self):
        certificate = json.loads((self.folder / "theorem-2.json").read_text())
        certificate["hypotheses"].append({"id": "pushes-end", "agents": [], "answer": "holds", "proof": {"kind": "number", "value": 0}})

        def judged(torque, by="torque_n_m", law="adaptive"):
            push = f'[[external_wrenches]]\non = ["arm-1"]\nby.{by} = ["{torque}", 0]\n[network]'
            text = place_of("theorem-2").read_text().replace("[network]", push)
            if law == "known": text = text.replace("[law.adaptive]", "[law.known]").replace("adaptation_gain = 10", "")  # noqa: E701
            found = checker.check(json.dumps(certificate), text, SCENARIOS, digests=False)
            return next(one[3] for one in found if one[0] == "pushes-end")

        for torque in ("exp(-t)", "3*exp(-0.05*t)*sin(t)", "2/(1 + t)", "sin(t)/(1 + t^2)"):
            for law in ("adaptive", "known"):
                self.assertEqual(judged(torque, law=law), checker.ACCEPTED, torque)
        for torque in ("sin(t)", "1/sqrt(1 + t)", "t/(1 + t)", "1/(t - 30)^2"):
            self.assertNotEqual(judged(torque), checker.ACCEPTED, torque)
        # A force on a link acts by a factor that may depend on where the robot is, and a hand holds.
        self.assertEqual(judged("exp(-t)", "wrench.force_n"), checker.REJECTED)
        self.assertEqual(judged("exp(-t)", "virtual_spring_on_axes.target_rad"), checker.REJECTED)

    def test_delays_are_constant_however_they_are_written(self):
        name, each, constant = "first-order", "common-first-root", "delay.constant_s = 0.3"
        kind = lambda entry: entry.update(proof={"kind": "constant"})  # noqa: E731
        for delay in ("saw_tooth = { min_s = 0.3, max_s = 0.3, period_s = 1 }", "sinusoid = { mean_s = 0.3, period_s = 1 }",
                      "random_hold = { hold_s = [1, 2], value_s = [0.3, 0.3], seed = 1 }",
                      "piecewise_constant = { times_s = [0, 1], values_s = [0.3, 0.3] }",
                      "piecewise_constant = { times_s = [0, 1], values_s = [0.3, 0.3], period_s = 2 }",
                      # From its last value on it does not change.
                      "piecewise_constant = { times_s = [0, 1], values_s = [0.1, 0.3] }"):
            self.accepted(name, each, kind, (constant, f"delay.{delay}"))
        for delay in ("saw_tooth = { min_s = 0.2, max_s = 0.3, period_s = 1 }", "sinusoid = { mean_s = 0.3, amplitude_s = 0.1, period_s = 1 }",
                      "piecewise_constant = { times_s = [0, 1], values_s = [0.1, 0.3], period_s = 2 }", "saw_tooth = { max_s = 0.3, period_s = 1 }",
                      "random_hold = { hold_s = [1, 2], value_s = [0.2, 0.3], seed = 1 }", 'formula_s = "0.3 + 0.1*sin(t)"', "packets = { period_s = 1 }"):
            self.rejected(name, each, "is not so by the text", kind, (constant, f"delay.{delay}"))

    def test_gains_that_grow_stay_positive_definite(self):
        self.accepted("swarm-tracking", "swarm-coupling", lambda entry: None, ("coupling = 12", "coupling = 13"))

    def test_a_default_namespace_of_a_urdf_changes_nothing(self):
        robot = (HERE.parent / "crates" / "io" / "robots" / "ur5e.urdf").read_text()
        self.assertIn("<robot ", robot)
        for mark in (' xmlns="http://own"', " xmlns='http://own'"):
            with tempfile.TemporaryDirectory() as folder:
                (Path(folder) / "ur5e.urdf").write_text(robot.replace("<robot ", f"<robot{mark} ", 1))
                certificate = (self.folder / "task-space-ur5e.json").read_text()
                found = checker.check(certificate, place_of("task-space-ur5e").read_text(), Path(folder), digests=False)
                self.assertNotIn(checker.REJECTED, [one[3] for one in found], found)
                self.assertIn(checker.ACCEPTED, [one[3] for one in found if one[0] == "uniform-inertia"])

    def test_a_thrust_may_be_spoken_about_once_for_each_kind_of_robot(self):
        document = json.loads((self.folder / "theorem-4.json").read_text())
        thrusts = [entry for entry in document["hypotheses"] if entry["id"] == "nonzero-thrust"]
        document["hypotheses"] += thrusts
        found = checker.check(json.dumps(document), place_of("theorem-4").read_text(), SCENARIOS, digests=False)
        self.assertEqual(len([one for one in found if one[0] == "nonzero-thrust" and one[3] != checker.REJECTED]), 2 * len(thrusts), found)

    def test_the_edge_of_what_a_planar_arm_reaches_is_out_of_reach(self):
        out = lambda entry: entry.update(answer="violated", proof={"kind": "out-of-reach", "t_s": "0"})  # noqa: E731
        old = '["0.8 + 0.3*cos(t)", "0.6 + 0.3*sin(t)"]'
        for edge in ("0.2", "1.8"): self.accepted("theorem-6", "target-within-reach", out, (old, f'["{edge}", "0"]'))
        for inside in ("0.2000001", "1.7999999"):
            self.rejected("theorem-6", "target-within-reach", "is no time", out, (old, f'["{inside}", "0"]'))

    def test_lengths_of_a_tree_are_those_of_its_geometry(self):
        scenario = checker.Scenario(place_of("task-space-ur5e").read_text(), SCENARIOS)
        agent, half = scenario.agents[0], math.pi / 2
        base, _, most = checker.outstretched(scenario, agent)
        self.assertEqual([float(low) for low, _ in base], [0, 0, 0])
        # The wrist stays bent: its links count as one, from elbow to tool, by rotations in floating point.
        x, y, z = 0.0, 0.0, 0.15 + 0.0996
        for angles, (dx, dy, dz), turn in (((-half, 0, 0), (0, 0, 0.0997), 0.0), ((half, 0, 0), (0, 0, 0.1333), -1.57),
                                          ((0, 0, 0), (-0.3922, 0, 0), -3.14)):
            x, y = x * math.cos(turn) - y * math.sin(turn), x * math.sin(turn) + y * math.cos(turn)
            y, z = y * math.cos(angles[0]) - z * math.sin(angles[0]), y * math.sin(angles[0]) + z * math.cos(angles[0])
            x, y, z = x + dx, y + dy, z + dz
        self.assertAlmostEqual(math.sqrt(float(most[0])), 0.1625 + 0.425 + math.hypot(x, y, z), 12)
        self.assertLess(most[1] - most[0], 1e-40)
        robot = scenario.text_of("ur5e.urdf")
        placed = '<child link="shoulder_link"/><origin xyz="1 2 3" rpy="0 0 1"/>'
        scenario.text_of = lambda _: robot.replace('<child link="shoulder_link"/>', placed)
        agent.gains["end_effector"]["coordinates"] = ["z", "x", "y"]
        base, _, longer = checker.outstretched(scenario, agent)
        self.assertEqual([float(low) for low, _ in base], [3, 1, 2])
        self.assertAlmostEqual(float(longer[0]), float(most[0]), 12)
        # With its first joint locked as well it starts at the second: turned by that joint and by the place of the first.
        agent.body["locked"]["shoulder_pan_joint"] = checker.Fraction(1, 2)
        scenario.text_of = lambda _: robot.replace('<child link="shoulder_link"/>', placed).replace('xyz="0 0 0.1625"', 'xyz="2 0 0"')
        base, _, shorter = checker.outstretched(scenario, agent)
        self.assertAlmostEqual(float(base[1][0]), 1 + 2 * math.cos(1.5), 12)
        self.assertAlmostEqual(math.sqrt(float(shorter[0])), 0.425 + math.hypot(x, y, z), 12)
        # Turned about an oblique axis the three locked joints of the wrist keep the length of what each carries.
        scenario.text_of = lambda _: robot.replace('<axis xyz="0 0 1"/>', '<axis xyz="0 3 4"/>')
        _, _, oblique = checker.outstretched(scenario, agent)
        self.assertLess(abs(oblique[1] - oblique[0]), 1e-40)
        self.assertLess(math.sqrt(float(oblique[1])), 0.425 + 0.3922 + 0.1333 + 0.0997 + 0.0996 + 0.15)
        scenario.text_of = lambda _: robot.replace('type="revolute"', 'type="prismatic"')
        self.assertRaises(checker.Undecided, checker.outstretched, scenario, agent)

    def test_friction_and_bounds(self):
        self.accepted("friction", "smooth-friction")
        self.rejected("friction", "smooth-friction", "by the text", lambda entry: None, ("friction.smooth", "friction.dry"))
        for none in ("coulomb = 0", "coulomb = [0, 0, 0, 0, 0, 0]"):
            without = ("coulomb = [2, 2, 2, 0.5, 0.5, 0.5]", none)
            self.rejected("friction", "smooth-friction", "is not asked for", lambda entry: None, without)
        # What the URDF states, which is none.
        self.rejected("friction", "smooth-friction", "is not asked for", lambda entry: None, ("coulomb = [2, 2, 2, 0.5, 0.5, 0.5], ", ""))
        self.accepted("bounds", "parameters-within-bounds", lambda entry: None, ("upper = [2.5]", "upper = [2]"))
        for bounds in (("lower = [2]", "lower = [2.001]"), ("upper = [2.5]", "upper = [1.999]"), ("mass_kg = 2,", "mass_kg = 3,")):
            self.rejected("bounds", "parameters-within-bounds", "by the text", lambda entry: None, bounds)
        for none in ("0", "-0.1"):
            self.rejected("friction", "parameters-within-bounds", "by the text", lambda entry: None, ("within = 0.3", f"within = {none}"))
            self.rejected("tip-velocity", "parameters-within-bounds", "by the text", lambda entry: None, ("within = 0.3", f"within = {none}"))
        unknown = ("law.adaptive.bounds", "parameter_variation = { seed = 1, relative = 0.1 }\nlaw.adaptive.bounds")
        judged, found = self.judged("bounds", "parameters-within-bounds", lambda entry: None, unknown)
        self.assertIn((checker.UNCHECKED, "the parameters of this robot are not computed here"), judged, found)

    def test_factors_of_inputs(self):
        small = ('parameters = [-0.5, 0.7] }', 'parameters = [-0.5, 0.7], psi = "1e-4" }')
        state = ('parameters = [-0.5, 0.7] }', 'parameters = [-0.5, 0.7], psi = "2 + x" }')
        factor = lambda entry: entry.update(answer="violated", proof={"kind": "factor", "agent": "cart-1"})  # noqa: E731
        for change in (small, state):
            self.rejected("saturated-coupling", "input-factor", "is not so", lambda entry: None, change)
        self.accepted("saturated-coupling", "input-factor", factor, small)
        self.rejected("saturated-coupling", "input-factor", "no factor below", factor)
        # The floor itself is not below it.
        self.rejected("saturated-coupling", "input-factor", "no factor below", factor, (small[0], small[1].replace("1e-4", "1e-3")))
        # In a state: ψ = 2 + x is 10⁻⁴ at −1.9999.
        there = lambda *state: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "factor", "agent": "cart-1", "state": list(state)})
        self.accepted("saturated-coupling", "input-factor", there("-1.9999", "0"), state)
        self.rejected("saturated-coupling", "input-factor", "no factor below", there("-1.99", "0"), state)
        self.rejected("saturated-coupling", "input-factor", "no factor below", there(), state)
        # Of a pure-feedback chain the factor is a slope, which is nowhere zero here, not where x1 is either.
        zero = lambda entry: entry.update(answer="violated", proof={"kind": "factor", "agent": "chain-1", "state": ["0", "0"]})  # noqa: E731
        self.rejected("pure-feedback", "input-factor", "no factor below", zero)

    def test_equations_that_no_next_state_moves(self):
        unmoved = lambda agent, equation: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "unmoved", "agent": agent, "equation": equation})
        still = ('known = ["x2 + 0.2*x2^3", "0"], regressors = [["x1^2 + 0.3*tanh(x2)"', 'known = ["x1", "0"], regressors = [["x1^2"')
        self.accepted("pure-feedback", "input-factor", unmoved("chain-1", 1), still)
        self.rejected("pure-feedback", "input-factor", "is moved by x2", unmoved("chain-1", 1))
        # By a parameter alone, or by what is known alone.
        for old, new in (("x2 + 0.2*x2^3", "x1"), ("x1^2 + 0.3*tanh(x2)", "x1^2")):
            self.rejected("pure-feedback", "input-factor", "is moved by x2", unmoved("chain-1", 1), (old, new))
        # An input moves the last one, and there is none before the first.
        for equation in (2, 0):
            self.rejected("pure-feedback", "input-factor", "none that a next state moves", unmoved("chain-1", equation))
        # Of a strict-feedback chain the next state stands beside the terms of an equation.
        self.rejected("strict-feedback", "input-factor", "is no pure-feedback chain", unmoved("second", 1))
        self.rejected("pure-feedback", "input-factor", "is no chain", unmoved("nobody", 1), still)

    def test_vectors_that_a_matrix_takes_to_zero(self):
        null = lambda agent, *vector: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "null-vector", "agent": agent, "vector": list(vector)})
        flat = ('psi = [["2", "0.5"], ["-0.3", "1 + x1^2"]]', 'psi = [["0.1", "0.3"], ["0.3", "0.9"]]')
        self.accepted("vector-plants", "input-factor", null("tanks", "3", "-1"), flat)
        # What comes closer to zero than the floor of 1e-3 allows is no better.
        self.accepted("vector-plants", "input-factor", null("tanks", "3", "-1.003"), flat)
        for vector in (("0", "0"), ("1", "0"), ("3", "-1.004")):
            self.rejected("vector-plants", "input-factor", "is taken neither to zero", null("tanks", *vector), flat)
        self.rejected("vector-plants", "input-factor", "has no matrix", null("tanks", "3", "-1", "0"), flat)
        # Of more columns than rows there is always such a vector.
        wide = (flat[0], 'psi = [["0.1", "0.3", "0"], ["0.3", "0.7", "0"]]')
        self.rejected("vector-plants", "input-factor", "has no matrix", null("tanks", "0", "0", "1"), wide)
        self.rejected("strict-feedback", "input-factor", "has no matrix", null("second", "1"))
        _, found = self.judged("vector-plants", "input-factor", null("tanks", "3", "-1"))
        self.assertNotIn(checker.ACCEPTED, [one[3] for one in found if one[0] == "input-factor"], found)
        # In one state: 0.5 − x1 and 1 are not above 1e-3 where x1 is 0.5, and are where it is 0.6.
        turns = (flat[0], 'psi = [["0.5 - x1", "0"], ["0", "1"]]')
        there = lambda state: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "null-vector", "agent": "tanks", "vector": ["1", "0"], "state": list(state)})
        self.accepted("vector-plants", "input-factor", there(("0.4995", "0")), turns)
        for state in (("0.498", "0"), ("0", "0.5")):
            self.rejected("vector-plants", "input-factor", "is taken neither to zero", there(state), turns)

    def test_thrusts_that_start_at_their_floor(self):
        below = lambda entry: entry.update(answer="violated", proof={"kind": "starts-below"})  # noqa: E731
        equal = ("parameter_variation = { seed = 4, relative = 0.4 }", "")
        says = lambda *own: ("[law.thrust]\n", "\n".join(["[law.thrust]", *own, ""]))  # noqa: E731
        # Each weighs 14.715 N.
        for own in (("thrust_start_n = 3", "floor.stops_n = 3"), ("thrust_start_n = 1.4715",), ("floor.stops_n = 14.715",)):
            self.accepted("theorem-4", "nonzero-thrust", below, equal, says(*own))
        kept = ("thrust_start_n = 0.5", "floor.kept = { thrust_n = 1 }")
        for own in ((), ("thrust_start_n = 3", "floor.stops_n = 2.9"), ("thrust_start_n = 1.472",), ("floor.stops_n = 14.71",), kept):
            self.rejected("theorem-4", "nonzero-thrust", "is not so by the text", below, equal, says(*own))
        self.unchecked("theorem-4", "nonzero-thrust", "is drawn", below, says("thrust_start_n = 0.1"))

    def test_matrices_of_inputs_are_bounded_from_below(self):
        """Of two rows |A|² = σ₁² + σ₂² and |det A| = σ₁ σ₂ give the smaller of the singular values."""
        draw = random.Random(5)
        shown = 0
        for case in often(200):
            rows = [[draw.randint(-6, 6) for _ in range(2)] for _ in range(2)]
            norm, det = sum(x * x for row in rows for x in row), rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
            least = math.sqrt(max(norm - math.sqrt(max(norm**2 - 4 * det**2, 0)), 0) / 2)
            found, most = checker.regular([[str(x) for x in row] for row in rows])
            self.assertLessEqual(float(found), least + 1e-9, rows)
            self.assertEqual(most, math.inf)
            # The determinant alone shows |det A|/|A|.
            if det: self.assertGreaterEqual(float(found), abs(det) / math.sqrt(norm) - 1e-9, rows)
            shown += found > 0
        self.assertGreater(shown, len(often(150)))
        # Without a bound of the entries by the discs alone, which show nothing where the diagonal is too small.
        self.assertEqual(checker.regular([["3 + x^2", "1"], ["-1", "2"]])[0], 1)
        self.assertLess(checker.regular([["1 + x^2", "2"], ["2", "2"]])[0], 0)
        self.assertAlmostEqual(float(checker.regular([["0", "2", "0"], ["0", "0", "2"], ["2", "0", "0"]])[0]), 8 * 2 / 12, 9)
        for rows in ([["1", "0"], ["0"]], [["1"], ["1"]]):
            self.assertRaises(checker.Meaningless, checker.regular, rows)
        self.assertEqual(checker.regular([["0", "0"], ["0", "0"]])[0], 0)
        # The determinant of seven rows takes too long.
        seven = [["2" if j == (i + 1) % 7 else "0" for j in range(7)] for i in range(7)]
        self.assertLess(checker.regular(seven)[0], 0)

    def test_inertias(self):
        arm = "robot.planar_arm = { mass_kg = [2.0, 1.5], length_m = [1.0, 0.8] }"
        limp = arm[:-2] + ", com_m = [0.5, 0.0], inertia_kg_m2 = [0.2, %s] }"
        self.accepted("theorem-2", "uniform-inertia", lambda entry: None, (arm, limp % "1e-9"))
        self.rejected("theorem-2", "uniform-inertia", "no robot has", lambda entry: None, (arm, limp % "0"))
        ship = "sway_kg = 33.8, sway_yaw_kg_m = 1.1, yaw_kg_m2 = 2.8"
        self.assertIn(ship, place_of("five-ships").read_text())
        even = "sway_kg = 4, sway_yaw_kg_m = %s, yaw_kg_m2 = 9"
        self.accepted("five-ships", "uniform-inertia", lambda entry: None, (ship, even % "-5.999"))
        self.rejected("five-ships", "uniform-inertia", "no robot has", lambda entry: None, (ship, even % "-6"))
        self.rejected("bounds", "uniform-inertia", "mass_kg must be positive", lambda entry: None, ("mass_kg = 2,", "mass_kg = 0,"))
        self.accepted("five-ships", "bounded-dynamics")

    def test_signs_are_solved_for_often_enough(self):
        roots = "roots_per_s = [1.0]"
        for period, judge in (("0.01", self.accepted), ("0.0101", None), ("2", None)):
            change = roots, f"{roots}\nsign_period_s = {period}"
            if judge:
                judge("theorem-8", "set-valued-sign", lambda entry: None, change)
            else:
                self.rejected("theorem-8", "set-valued-sign", "is not so", lambda entry: None, change)
        # Where torques come late, or velocities are filtered, (110) sees too late what it did.
        for control, judge in (("", self.accepted), ("computation_delay_s = 1e-5", None), ("velocity.filtered_difference.cut_off_hz = 60", None)):
            change = "[[agents]]", f"[control]\nsample_hz = 2000\n{control}\n\n[[agents]]"
            if judge:
                judge("theorem-8", "set-valued-sign", lambda entry: None, change)
            else:
                self.rejected("theorem-8", "set-valued-sign", "is not so", lambda entry: None, change)

    def test_terms_of_chains_have_values_everywhere(self):
        for text, fine in (("x^2 - sin(x)/3", True), ("1/(1 + x^2)", True), ("sqrt(1 + x^2)", True), ("abs(x)^1.5", True), ("abs(x)^0.5", None), ("x^1.5", None), ("1/x", None),
                           ("sqrt(x^2)", None), ("log(2 + cos(x))", True), ("x/0", None), ("x^-2", None)):
            tree = checker.formula(text, checker.STATES)
            if fine:
                self.assertTrue(checker.everywhere(tree), text)
            else:
                self.assertRaises(checker.Undecided, checker.everywhere, tree)
        # Backstepping takes derivatives, which powers bear up to their exponents.
        for text, taken, fine in (("(x1^2)^1.25", 1, True), ("(x1^2)^1.25", 3, None), ("(x1^2)^2.5", 2, True), ("(x1^2)^2.5", 3, None),
                                  ("sin((x1^2)^1.5)", 2, None), ("(1 + x1^2)^0.25", 3, True), ("x1^3", 9, True)):
            tree = checker.formula(text, checker.STATES)
            if fine:
                self.assertTrue(checker.everywhere(tree, taken), text)
            else:
                self.assertRaises(checker.Undecided, checker.everywhere, tree, taken)

    def test_what_the_text_says(self):
        limits = ("[network]", "[control]\nsample_hz = 100\ntorque_limit = 5\n[network]")
        self.rejected("theorem-2", "applied-torque", "by the text", lambda entry: None, limits)
        forged = json.loads((self.folder / "formation.json").read_text())
        for entry in forged["hypotheses"]:
            if entry["id"] == "applied-torque":
                self.assertEqual(entry["answer"], "not covered by the paper")
                entry.update(answer="holds", proof={"kind": "text"})
        found = checker.check(json.dumps(forged), place_of("formation").read_text(), SCENARIOS, digests=False)
        self.assertIn("by the text", " ".join(one[4] for one in found if one[3] == checker.REJECTED))
        self.rejected("swarm-tracking", "mutual-weights", "by the text", lambda entry: None, ('["arm-2", "arm-1"], ', ""))
        self.rejected("theorem-9", "no-delay", "by the text", lambda entry: None, ("[network]", "[network]\ndelay.constant_s = 0.1"))
        one = ('["leader", "arm-1"]', '{ from = "leader", to = "arm-1", delay.constant_s = 0.1 }')
        self.rejected("theorem-9", "no-delay", "by the text", lambda entry: None, one)
        self.rejected("theorem-8", "set-valued-sign", "by the text", lambda entry: None, ("gain = 2 ", 'gain = 2\nsign = "explicit" #'))
        self.rejected("theorem-1", "fixed-graph", "by the text", lambda entry: None, ("[network]", '[network]\nweight = "2 + sin(t)"'))
        more = ("edges = [[", "[[network.phases]]\ndwell_s = 1\nedges = []\n[[network.phases]]\ndwell_s = 1\nedges = [[")
        self.rejected("theorem-1", "fixed-graph", "by the text", lambda entry: None, more)
        self.rejected("theorem-1", "dwell-time", "by the text", lambda entry: None, more)

    def test_the_list_of_hypotheses(self):
        whole = json.loads((self.folder / "theorem-2.json").read_text())
        text = place_of("theorem-2").read_text()

        def said(change, scenario=text):
            certificate = copy.deepcopy(whole)
            change(certificate)
            found = checker.check(json.dumps(certificate), scenario, SCENARIOS, digests=False)
            return [one[4] for one in found if one[3] == checker.REJECTED]

        self.assertEqual(said(lambda certificate: None), [])
        for k in range(len(whole["hypotheses"])):
            self.assertEqual(said(lambda certificate: certificate["hypotheses"].pop(k)), ["is left out"])
        self.assertIn("speaks twice", said(lambda c: c["hypotheses"].append(c["hypotheses"][0])))
        self.assertIn("must be theorem-2", said(lambda certificate: certificate.update(theorem="theorem-1")))
        self.assertIn("has `more`, which means nothing here", said(lambda c: c["hypotheses"][0]["proof"].update(more=1)))
        foreign = {"id": "no-delay", "agents": [], "answer": "holds", "proof": {"kind": "text"}}
        self.assertIn("is not asked for by this scenario", said(lambda c: c["hypotheses"].append(foreign)))
        self.assertEqual(said(lambda certificate: None, text.replace("[network]", "[control]\nsample_hz = 100\n[network]")), ["is left out"])
        baseless = {"id": "continuous-time", "agents": [], "answer": "holds"}
        sampled_ = text.replace("[network]", "[control]\nsample_hz = 100\n[network]")
        self.assertIn("is a claim that nothing before a run shows", said(lambda c: c["hypotheses"].append(baseless), sampled_))

    def test_digests_of_files_beside_the_scenario_count(self):
        text, folder = place_of("logs").read_text(), place_of("logs").parent

        def said(change, digests=True):
            certificate = json.loads((self.folder / "logs.json").read_text())
            change(certificate["scenario"])
            return [one[4] for one in checker.check(json.dumps(certificate), text, folder, digests) if one[3] == checker.REJECTED]

        self.assertEqual(said(lambda scenario: None), [])
        for k in (0, 1):
            other = lambda scenario: scenario["inputs"][k].update(sha256="0" * 64)  # noqa: E731, B023
            self.assertEqual(said(other), ["is not that of the file"])
            self.assertEqual(said(other, False), [])
        self.assertEqual(said(lambda scenario: scenario.update(sha256="0" * 64)), ["is not that of the scenario"])
        # A mesh, which is not read here.
        self.assertEqual(said(lambda scenario: scenario["inputs"].append({"file": "arm.stl", "sha256": "0" * 64})), [])

    def test_every_measurement_that_is_inexact_is_asked_for(self):
        for entry in ("noise.position = 1e-4", "noise.velocity = 1e-4", "quantisation.velocity = 1e-3", 'velocity.filtered.cutoff_hz = 20'):
            scenario = checker.Scenario(place_of("theorem-2").read_text().replace(
                "[network]", f"[control]\nsample_hz = 100\n{entry}\n[network]"), SCENARIOS)
            self.assertIn(("exact-measurements", ""), checker.requirements(scenario), entry)
        exact = checker.Scenario(place_of("theorem-2").read_text().replace("[network]", "[control]\nsample_hz = 100\n[network]"), SCENARIOS)
        self.assertNotIn(("exact-measurements", ""), checker.requirements(exact))

    def test_one_vehicle_with_a_bias_or_another_design_is_enough(self):
        agent = lambda bias=(0, 0, 0), design="continuous": type("Agent", (), {  # noqa: E731
            "law": "thrust", "gains": {"design": {design: {}}}, "settings": lambda _: {"bias_m_s2": list(bias)}})()
        scenario = lambda *agents: type("Scenario", (), {"agents": agents})  # noqa: E731
        of = lambda each, *agents: checker.TEXT[each, "text"](scenario(*agents), [])  # noqa: E731
        self.assertTrue(of("unbiased-acceleration", agent(), agent()))
        self.assertFalse(of("unbiased-acceleration", agent(), agent((0, 0.1, 0))))
        self.assertTrue(of("known-masses", agent(), agent()))
        self.assertFalse(of("known-masses", agent(), agent(design="adaptive")))

    def test_stretches_on_which_derivatives_are_bounded(self):
        """A divisor that is no less than 0.4, as pieces show, and [1, ∞) at once does not."""
        name, each, narrow = "desired-target", "bounded-target", ('"sin(t)"', '"1/(1.6 - sin(t) - cos(2*t))"')
        short = ("end_s = 20", "end_s = 2")

        def on(answer="holds", **stretch):
            return lambda entry: entry.update(answer=answer, proof={"kind": "derivatives", "order": 3, "stretch": stretch})
        self.accepted(name, each, on(range="period", cells=30), narrow)
        self.unchecked(name, each, "does not bound derivative 0", on(range="for-ever"), narrow)
        self.unchecked(name, each, "does not bound derivative 0", on(range="period", cells=2), narrow)
        self.rejected(name, each, "does not bound derivative 0", on(range="for-ever"), ('"sin(t)"', '"t*sin(t)"'))
        # All that comes after a run is known of a formula, and counts.
        for answer in ("holds", "holds on [0, end]"):
            self.rejected(name, each, "is of no known kind", on(answer, range="run", cells=10), narrow, short)

    def test_what_may_mean_something_unknown_is_not_accepted(self):
        """A key, or a kind, that came after the checker."""
        changes = (("[network]", "dropout = 0.5\n[network]"), ("[network]", "[network]\ndropout = 0.5"), ("count = 6", "count = 6\nslack = 1"),
                   ("exchange = ", "more = 1\nexchange = "), ("adaptation_gain = 10", "adaptation_gain = 10\nleak = 1"),
                   ("damping.gain = 8", "damping.more = 8"), ("delay.sinusoid", "delay.wobble"), ("robot.planar_arm", "robot.snake"))
        certificate = (self.folder / "theorem-2.json").read_text()
        for old, new in changes:
            text = place_of("theorem-2").read_text()
            self.assertIn(old, text)
            found = checker.check(certificate, text.replace(old, new, 1), SCENARIOS, digests=False)
            unknown = [one for one in found if one[3] == checker.UNCHECKED and "are not known" in one[4]]
            self.assertTrue(unknown, (new, found))

    def test_nobody_is_heard_by_a_leader(self):
        """So that a root is the leader: otherwise a follower might be one."""
        heard = ('edges = [["leader", "arm-1"]', 'edges = [["arm-1", "leader"]')
        self.rejected("theorem-8", "leader-reaches-all", "to the leader", lambda entry: None, heard)

    def test_a_leader_in_every_graph(self):
        name, each = "leader-over-turns", "leader-in-every-graph"
        gone = ('["leader", "arm-4"], ', "")
        unheard = lambda phase, *group: lambda entry: entry.update(  # noqa: E731
            answer="violated", proof={"kind": "unheard", "phase": phase, "group": list(group)})
        self.accepted(name, each)
        self.rejected(name, each, "is no edge", lambda entry: None, gone)
        self.rejected(name, each, "one for each phase", lambda entry: entry["proof"]["windows"].pop())
        self.accepted(name, each, unheard(2, "arm-4"), gone)
        self.accepted(name, each, unheard(2, "arm-4", "arm-3", "arm-2", "arm-1"), gone)
        self.rejected(name, each, "is not closed", unheard(2, "arm-4"))
        self.rejected(name, each, "is not closed", unheard(1, "arm-4"), gone)
        self.rejected(name, each, "is not closed", unheard(2, "arm-3"), gone)
        self.rejected(name, each, "does not recur", unheard(4, "arm-4"), gone)
        self.rejected(name, each, "must name agents", unheard(2, "leader"), gone)
        self.rejected(name, each, "must name agents", unheard(2), gone)
        # With delays besides it is another statement, and so are graphs that do not take turns.
        self.rejected("leader-over-late-links", "bounded-delays", "theorem", lambda entry: None, ("delay.random_hold = { seed = 7, "
                      "hold_s = [0.1, 0.3], value_s = [0.0, 0.05] }", "delay.constant_s = 0"))

    def test_polynomials_of_targets(self):
        name, each = "desired-target", "desired-dynamics"
        put = lambda kind, answer, *column: lambda entry: entry.update(answer=answer, proof={"kind": kind, "column": list(column)})  # noqa: E731
        by = lambda text: ("polynomial = [6, 11, 6]", f"polynomial = {text}")  # noqa: E731
        shown, refuted = lambda *column: put("routh", "holds", *column), lambda *column: put("no-routh", "violated", *column)  # noqa: E731
        _, found = self.judged(name, each, lambda entry: None)
        self.assertEqual({one[3] for one in found}, {checker.ACCEPTED}, found)
        self.rejected(name, "bounded-target", "too low", lambda entry: entry["proof"].update(order=2))
        # p³ + 6 p² + 11 p + 6, and with another constant that stays below 66.
        self.accepted(name, each, shown(1, "6.0", 10, "6"))
        self.accepted(name, each, shown(1, 6, "11/600", "65.89"), by("[65.89, 11, 6]"))
        self.rejected(name, each, "first column", lambda entry: None, by("[7, 11, 6]"))
        self.rejected(name, each, "first column", shown(1, 6, 11, 6))
        self.rejected(name, each, "first column", shown(1, 6, 10))
        # On the axis and beyond it: a row begins with zero, or with what is negative.
        for constant, entry in ((66, 0), (72, -1)):
            self.accepted(name, each, refuted(1, 6, entry), by(f"[{constant}, 11, 6]"))
            self.rejected(name, each, "opposite", shown(1, 6, entry), by(f"[{constant}, 11, 6]"))
        self.rejected(name, each, "opposite", refuted(1, 6, 10, 6))
        # By roots, p (p + 1) (p² + 2 p + 5) = p⁴ + 3 p³ + 7 p² + 5 p: the row of the constant vanishes.
        roots = "{ integrators = 1, roots_per_s = [1, { real = 1, imaginary = 2 }] }"
        self.accepted(name, each, refuted(1, 3, "16/3", 5, 0), by(roots))
        # Of what hears neighbours as well, or has a term that is not linear, nothing is known.
        for more in ("coupling_polynomial = [0]", "heard = [1]", 'nonlinear = "-x^3"'):
            judged, found = self.judged(name, each, lambda entry: None, ("follows_target = true", f"follows_target = true\n{more}"))
            self.assertEqual([outcome for outcome, _ in judged], [checker.UNCHECKED], found)

    def test_routh_tells_polynomials_by_their_roots(self):
        draw = random.Random(8)
        for _ in often(300):
            signs, p = [draw.choice((1, 1, 1, 1, -1)) for _ in range(draw.randrange(1, 6))], [checker.Fraction(1)]
            for sign in signs:
                a, b = checker.Fraction(draw.randrange(1, 30), 7), checker.Fraction(draw.randrange(0, 40), 7)
                p = checker.convolved(p, draw.choice(([sign * a, checker.Fraction(1)], [a * a + b * b, sign * 2 * a, checker.Fraction(1)])))
            self.assertEqual(checker.routh(p)[-1] > 0, min(signs) > 0, p)

    def test_logs(self):
        name, logs = "logs", {file: (HERE / "cases" / file).read_text() for file in ("logs-phases.csv", "logs-holds.csv")}
        with tempfile.TemporaryDirectory() as files:
            def beside(file=None, old="", new=""):
                for each, text in logs.items():
                    self.assertTrue(each != file or old in text)
                    (Path(files) / each).write_text(text.replace(old, new, 1) if each == file else text)
                return {"files": Path(files)}

            def said(each, spoil_proof=lambda entry: None, **other):
                return self.judged(name, each, spoil_proof, **other)[0][0]

            put = lambda **fields: lambda entry: entry["proof"].update(fields)  # noqa: E731
            for each in ("spanning-tree", "dwell-time", "bounded-delays"):
                self.assertEqual(said(each, **beside())[0], checker.ACCEPTED)
                # Nothing is known of what comes after a log.
                self.assertEqual(said(each, lambda entry: entry.update(answer="holds"), **beside())[0], checker.REJECTED)
            for each, spoilt, words in (("spanning-tree", put(longest_s="1.79"), "is exceeded"), ("dwell-time", put(shortest_s="0.41"), "not below"),
                                        ("bounded-delays", put(bound_s="0.29"), "is exceeded"), ("spanning-tree", put(kind="drawn"), "is not drawn")):
                outcome, what = said(each, spoilt, **beside())
                self.assertTrue(outcome == checker.REJECTED and words in what, (each, what))
            for each, file, old, new, words in (
                    ("spanning-tree", "phases", "0.8,2", "0.8,1", "phases that follow"), ("spanning-tree", "phases", "1.5,1", "1.5,3", "is none"),
                    ("spanning-tree", "phases", "5.5,", "4.9,", "not before the run"), ("spanning-tree", "phases", "5.5,", "5.5,2", "an empty line"),
                    ("spanning-tree", "phases", "1.5,1", "1.5,", "an empty line"), ("spanning-tree", "phases", "0,1", "0.1,1", "begin at 0"), ("dwell-time", "phases", "1.9,1", "1.6,1", "not below"),
                    ("bounded-delays", "holds", "1.5,0.25", "1.5,0.35", "is exceeded"), ("bounded-delays", "holds", "1.5,0.25", "1.5,-0.1", "negative"),
                    ("bounded-delays", "holds", "1,5,", "1,4.9,", "not before the run"), ("bounded-delays", "holds", "1,5,", "1,1.2,", "rise")):
                outcome, what = said(each, **beside(f"logs-{file}.csv", old, new))
                self.assertTrue(outcome == checker.REJECTED and words in what, (each, old, new, what))
            # Windows that would do for what repeats.
            tree = [["mass-1", "mass-2", 1], ["mass-2", "mass-3", 2]]
            proof = {"kind": "windows", "windows": [{"phases": [1, 2], "root": "mass-1", "arborescence": tree}]}
            for answer in ("holds", "holds on [0, end]"):
                found = said("spanning-tree", lambda entry: entry.update(answer=answer, proof=proof), **beside())
                self.assertEqual(found, (checker.UNCHECKED, "what comes after a log is not known"))
            # Other numbers with which the same bounds are right; a hold of another number is another one.
            for each, file, old, new in (("dwell-time", "phases", "1.9,1", "2,1"), ("spanning-tree", "phases", "5.5,", "5,"),
                                         # The last may be cut short.
                                         ("dwell-time", "phases", "4.1,2", "5.2,2"),
                                         ("bounded-delays", "holds", "1.5,0.25", "1.5,0.3"),
                                         ("bounded-delays", "holds", "mass-2,mass-3,1,0,0.3", "mass-2,mass-3,2,0,9\nmass-2,mass-3,1,0,0.3")):
                self.assertEqual(said(each, **beside(f"logs-{file}.csv", old, new))[0], checker.ACCEPTED, (each, old, new))

    def test_places_of_tools(self):
        name, each = "pose-ur5e", "lengths-within-bounds"
        self.accepted(name, each)
        # From the last joint: the link of the tool begins 0.0996 m further.
        self.accepted(name, each, lambda entry: None, ("at_m = [0, 0, 0.15]", "at_m = [0.05, 0, 0.2004]"))
        self.accepted(name, each, lambda entry: None, ("at_m = [0, 0, 0.15]", "at_m = [0, -0.05, -0.0496]"))
        for place in ("[0, 0, 0.2005]", "[0, 0, 0.3]", "[0, -0.06, 0.15]", "[0, 0, -0.0497]"):
            self.rejected(name, each, "by the text", lambda entry: None, ("at_m = [0, 0, 0.15]", f"at_m = {place}"))
        # Of the whole chain there are eighteen lengths, and six bounds.
        chain = ("at_m = [0, 0, 0.15]", 'at_m = [0, 0, 0.15], uncertain = "chain"')
        self.rejected(name, each, "by the text", lambda entry: None, chain)
        # Those of a URDF do not vary.
        self.accepted(name, each, lambda entry: None, ('name = "arm"', 'name = "arm"\nparameter_variation = { seed = 1, relative = 0.1 }'))

    def test_half_turns_at_the_start(self):
        name, each = "pose-ur5e", "start-attitude"
        self.accepted(name, each)
        self.accepted(name, each, lambda entry: entry["proof"].update(least="0.67"))
        self.rejected(name, each, "may be smaller", lambda entry: entry["proof"].update(least="0.672"))
        self.rejected(name, each, "may be smaller", lambda entry: entry["proof"].update(least="0"))
        self.rejected(name, each, "by the text", lambda entry: entry.update(answer="violated", proof={"kind": "half-turn"}))
        # Turned further by its last joint, and by its first.
        for further in ("0.4, -1.2, 1.6, -1.9, -1.5, 2.9", "2.4, -1.2, 1.6, -1.9, -1.5, 0.3"):
            mutated = ("0.4, -1.2, 1.6, -1.9, -1.5, 0.3", further)
            self.rejected(name, each, "may be smaller", lambda entry: entry["proof"].update(least="0.999"), mutated)

    def test_jacobians_that_are_singular_at_the_start(self):
        def taken(*vector):
            return lambda entry: entry.update(answer="violated", proof={"kind": "left-null", "vector": list(vector)})

        def bent(by):
            return "start.position_rad = [0.2, 1.4]", f"start.position_rad = [0.2, {by}]"
        each = "regular-jacobian"
        # Along the arm, which moves its tip only across.
        along = "0.98006657784", "0.19866933080"
        self.accepted("theorem-6", each, taken(*along), bent("0"))
        self.accepted("theorem-6", each, taken(*along), bent("3.14159265359"))
        self.accepted("theorem-6", each, taken(*along), bent("1e-6"))
        self.rejected("theorem-6", each, "not taken to zero", taken(*along), bent("1e-4"))
        self.rejected("theorem-6", each, "not taken to zero", taken(*along))
        self.rejected("theorem-6", each, "not taken to zero", taken("1", "0"), bent("0"))
        # How long the vector is does not matter.
        self.rejected("theorem-6", each, "not taken to zero", taken("1e-9", "0"), bent("0"))
        self.accepted("theorem-6", each, taken("980066577.84", "198669330.80"), bent("0"))
        self.rejected("theorem-6", each, "is zero", taken("0", "0"), bent("0"))
        self.rejected("theorem-6", each, "another length", taken(*along, "0"), bent("0"))
        # No length is known: nothing moves the tip that the law knows.
        scaled = "kinematic_start.scaled = 1.2", "kinematic_start = \"zero\""
        self.accepted("theorem-6", each, taken("1", "0"), scaled)
        self.rejected("pose-ur5e", each, "not taken to zero", taken("1", "0", "0", "0", "0", "0"))

    def test_jacobians_through_what_slides_and_turns_about_an_oblique_axis(self):
        folder = Path(__file__).resolve().parent / "cases"
        text = (folder / "slider.toml").read_text()

        def columns(*changes):
            scenario = checker.Scenario(functools.reduce(lambda text, change: text.replace(*change), changes, text), folder)
            return [[float(sum(entry)) / 2 for entry in column] for column in checker.jacobian(scenario, scenario.agents[0])]

        def are(found, expected):
            self.assertEqual(len(found), len(expected))
            for one, other in zip(itertools.chain(*found), itertools.chain(*expected)): self.assertAlmostEqual(one, other, 14)

        true, level = ('at_m = [0.05, 0, 0] }', 'at_m = [0.05, 0, 0] }\nkinematic_start = "true"'), ("-0.6435011087932844", "0")
        # By hand: the tip is at (1.4, 0.1, 0.5) from the axis (1, 1, 1)/√3, and the tool 0.2 m from where it turns.
        turning = [x / 3**0.5 for x in (0.5 - 0.1, 1.4 - 0.5, 0.1 - 1.4)]
        are(columns(true, level), [turning, [0.8, 0, 0.6], [0.2, 0, 0]])
        # A half more of the tool, which turns by a quarter, comes to lie along y of the turned frame, that is along z.
        longer = [x / 3**0.5 for x in (0.52 - 0.1, 1.4 - 0.52, 0.1 - 1.4)]
        are(columns(("at_m = [0.05, 0, 0] }", "at_m = [0.05, 0, 0] }\nkinematic_start.scaled = 1.1"), level),
            [longer, [0.8, 0, 0.6], [0.22, 0, 0]])
        # With all of the chain, (0, 0, 1), (0.1, 0, 0) and the tool; what the slide adds is known.
        chain = ("at_m = [0.05, 0, 0] }", 'at_m = [0.05, 0, 0], uncertain = "chain" }\nkinematic_start.scaled = 2')
        whole = [x / 3**0.5 for x in (0.7 - 0.2, 2.4 - 0.7, 0.2 - 2.4)]
        are(columns(chain, level), [whole, [0.8, 0, 0.6], [0.4, 0, 0]])
        # The slide locked where it stands: its travel is then a length like others.
        locked = ('robot.urdf = { file = "slider.urdf" }', 'robot.urdf = { file = "slider.urdf", locked.slide = 0.5 }')
        start = ("[2.0943951023931953, 0.5, ", "[2.0943951023931953, ")
        are(columns(true, level, locked, start), [turning, [0.2, 0, 0]])
        posed = ("at_m = [0.05, 0, 0] }", 'at_m = [0.05, 0, 0], follows = "pose" }\nkinematic_start = "true"')
        third = 1 / 3**0.5
        are(columns(posed, level), [[*turning, third, third, third], [0.8, 0, 0.6, 0, 0, 0], [0.2, 0, 0, 0, 1, 0]])
        name, each = "slider", "regular-jacobian"
        self.accepted(name, each)
        self.rejected(name, each, "not taken to zero", lambda entry: None, ("-0.6435011087932844", "-0.6436"))
        self.rejected(name, each, "not taken to zero", lambda entry: None, ("[0.05, 0, 0]", "[0.05, 0, 0.001]"))
        self.accepted(name, "certain-regressor")
        self.rejected(name, "certain-regressor", "by the text", lambda entry: None, chain)

    def test_attitudes_that_vanish(self):
        name, each, old = "theorem-7", "nonzero-quaternion", "target.formulas = [0, 0, 0, 1] "

        def target(*entries):
            return old, f"target.formulas = {json.dumps(entries)} "

        def fades(entry):
            entry.update(answer="violated", proof={"kind": "fades"})

        def vanishes(at_s):
            return lambda entry: entry.update(answer="violated", proof={"kind": "vanishes", "at_s": at_s})

        def turns(number, from_s, to_s):
            proof = {"kind": "changes-sign", "entry": number, "from_s": from_s, "to_s": to_s}
            return lambda entry: entry.update(answer="violated", proof=proof)
        self.accepted(name, each, fades, target("exp(-t)", "1/(1+t)", 0, "exp(-t)*sin(t)"))
        self.rejected(name, each, "by the text", fades, target("exp(-t)", 0, 0, "1e-9"))
        self.rejected(name, each, "by the text", fades)
        words, over = "no time at which", target(0, 0, 0, "1 - t/90")
        self.accepted(name, each, vanishes("90"), over)
        for other in ("89.999999999999999", "0", "-90"): self.rejected(name, each, words, vanishes(other), over)
        self.rejected(name, each, words, vanishes("-90"), target(0, 0, 0, "1 + t/90"))
        self.accepted(name, each, vanishes("0"), target(0, 0, 0, "t"))
        self.accepted(name, each, turns(4, "0", "2"), target(0, 0, 0, "cos(t)"))
        # Several entries pass zero together, or nearly.
        self.accepted(name, each, vanishes("90"), target("t/30 - 3", 0, "2 - t/45", "1 - t/90"))
        self.rejected(name, each, words, vanishes("90"), target("t/30 - 3", 0, "1e-30", "1 - t/90"))
        self.rejected(name, each, words, vanishes("90"), target("t/30 - 3", 0, "2 - t/45", "1 - t/91"))
        # π/2 is no rational number.
        self.rejected(name, each, words, vanishes("1.5707963267948966"), target(0, 0, 0, "cos(t)"))
        self.accepted(name, each, turns(4, "1.57", "1.58"), target(0, 0, 0, "cos(t)"))
        self.accepted(name, each, turns(3, "1.57", "1.58"), target("-cos(t)", 0, "cos(t)/7", "3*cos(t)"))
        self.rejected(name, each, "not the only one", turns(3, "1.57", "1.58"), target(0, 0, "cos(t)", "cos(t) + 1e-12"))
        self.rejected(name, each, "not the only one", turns(3, "1.57", "1.58"), target(0, 0, "cos(t)", "1e-12"))
        self.rejected(name, each, "one sign", turns(4, "91", "92"), over)
        self.rejected(name, each, "one sign", turns(4, "80", "90"), over)
        self.rejected(name, each, "one sign", turns(4, "80", "89"), over)
        self.rejected(name, each, "ends no stretch", turns(4, "91", "89"), over)
        self.rejected(name, each, "ends no stretch", turns(4, "-1", "91"), over)
        self.rejected(name, each, "is no entry", turns(5, "89", "91"), over)
        # A pole has two signs beside it and passes no zero.
        for proof in (vanishes("90"), turns(4, "89", "91")):
            _, found = self.judged(name, each, proof, target(0, 0, 0, "1/(t - 90)"))
            self.assertNotIn(checker.ACCEPTED, [entry[3] for entry in found if entry[0] == each], found)

    def test_edges_that_were_drawn(self):
        name = "drawn-graph"
        self.accepted(name, "spanning-tree")
        scenario = (Path(__file__).resolve().parent / "cases" / f"{name}.toml").read_text()

        def fate(spoil, text=scenario):
            document = json.loads((self.folder / f"{name}.json").read_text())
            spoil(document)
            return checker.check(json.dumps(document), text, Path("."), False)[-1]

        def edges(change): return lambda document: change(document["given_edges"][0])
        for spoil in (edges(lambda pairs: pairs.pop()), edges(lambda pairs: pairs.append(pairs[0])),
                      edges(lambda pairs: pairs[0].reverse()), edges(lambda pairs: pairs[0].__setitem__(0, pairs[0][1])),
                      edges(lambda pairs: pairs[0].__setitem__(0, "nobody")), edges(lambda pairs: pairs[0].pop())):
            *_, outcome, words, _ = fate(spoil)
            self.assertTrue(outcome == checker.REJECTED and "the rule can draw" in words, words)
        self.assertEqual(fate(lambda _: None)[:4], ("agreement", [], "holds", checker.ACCEPTED))
        self.assertEqual(fate(lambda document: document.pop("given_edges"))[3], checker.UNCHECKED)
        self.assertIn("not drawn", fate(lambda document: document["given_edges"].append([]))[4])
        self.assertIn("the rule can draw", fate(lambda _: None, scenario.replace("in_degree = 2", "in_degree = 3"))[4])
        # Among the first four everybody hears two, as is asked for; but the fifth is none of them.
        among = 'among = ["m-1", "m-2", "m-3", "m-4"], in_degree = 2'
        self.assertIn("the rule can draw", fate(lambda _: None, scenario.replace("in_degree = 2", among))[4])

    def test_pushes_by_formulas(self):
        pushed = ("[network]", '[[external_wrenches]]\non = ["arm-1"]\nby.torque = ["max(0, 1 - t)", 0]\n[network]')
        scenario = checker.Scenario(place_of("theorem-2").read_text().replace(*pushed), Path("."))
        (begin, end, trees, kind), (both, _) = scenario.agents[0].pushes[0], (checker.FOR_EVER, 0)
        self.assertEqual((begin, end, len(trees), kind), (0, checker.INF, 2, "torque"))
        one = checker.Fraction(1)
        self.assertTrue(all(checker.enclose(tree, (one, checker.INF)) == (0, 0) for tree in trees))
        self.assertNotEqual(checker.enclose(trees[0], (one * 9 / 10, checker.INF)), (0, 0))
        self.assertNotEqual(checker.enclose(trees[0], both), (0, 0))

    def test_leaders_with_roots(self):
        """√(1 + t + t²), of which α q̇ + q̈ is at most 1.25 at t = 0, and beside it motions of which it is not so, or has no value."""
        def by(motion, gain="1.3"):
            return [("motion.sinusoids = [", f'motion.formulas = ["{motion}", "0"]\n#'), ("    { offset = 0.3,", "#"), ("    { offset = -0.2,", "#"),
                    ("\n]", "\n#"), ("gain = 2 ", f"gain = {gain} ")]

        def ends(low, high, **stretch):
            zero = {"range": "for-ever", "within": ["0", "0"]}
            return lambda entry: entry.update(answer="holds", proof={"kind": "bounds", "bounds": [{**stretch, "within": [low, high]}, zero]})
        derivatives = lambda **stretch: lambda entry: entry.update(answer="holds", proof={"kind": "derivatives", "order": 3, "stretch": stretch})  # noqa: E731
        tail = {"range": "tail", "until_s": 16, "cells": 128}
        self.accepted("theorem-8", "sign-gain", ends("-1.29", "1.29", **tail), *by("sqrt(1 + t + t^2)"))
        self.rejected("theorem-8", "sign-gain", "does not hold", ends("-1.29", "1.1", **tail), *by("sqrt(1 + t + t^2)"))
        self.rejected("theorem-8", "sign-gain", "does not hold", ends("-1.29", "1.29", **tail), *by("sqrt(1 + t + 3*t^2)"))
        self.rejected("theorem-8", "sign-gain", "leaves", ends("-1.29", "1.29", **tail), *by("sqrt(1 + t + t^2)", "1.2"))
        for motion in ("sqrt(1 + t + t^2)", "sqrt(2 + (t - 3)^2)/(1 + t)", "sqrt(1 + t)*cos(sqrt(1 + t))", "sqrt(t^2 - 6*t + 11)"):
            self.accepted("theorem-8", "bounded-leader", derivatives(**tail), *by(motion))
        # It grows, swings ever faster, or has a root of what becomes zero, or negative.
        for motion in ("sqrt(1 + t^3)", "sqrt(1 + t)*cos(t)", "cos(sqrt(1 + t)*t)", "(1 + t)*sqrt(1 + t)", "sqrt(t)", "sqrt(t^2 - 6*t + 9)", "sqrt(9 - t)/(1 + t)"):
            judged, found = self.judged("theorem-8", "bounded-leader", derivatives(**tail), *by(motion))
            self.assertNotIn(checker.ACCEPTED, [outcome for outcome, _ in judged], (motion, found))

    def test_motions_that_swing_ever_wider(self):
        name, each, old = "formation", "bounded-target", "0.2*t + cos(0.3*t)"

        def diverges(order):
            return lambda entry: entry.update(answer="violated", proof={"kind": "diverges", "motion": 1, "axis": 1, "order": order})
        for target in ("t*sin(t)", "t*t*sin(2*t) + t*cos(t)", "1 - cos(t)*t*(t + 1)", "t^3 - 2*t^2"):
            self.accepted(name, each, diverges(2), (old, target))
        # Zero times t is bounded, two swings may cancel, and what is small enough fades.
        for target in ("t*(0*sin(t))", "sin(t)/(1 + t)", "t*sin(t)*exp(-t)"):
            self.rejected(name, each, "stays bounded", diverges(2), (old, target))
        judged, found = self.judged(name, each, diverges(2), (old, "t*sin(t) - t*sin(t)"))
        self.assertEqual([outcome for outcome, _ in judged], [checker.UNCHECKED], found)

    def test_what_is_said_to_diverge_does(self):
        name, each, old = "desired-target", "bounded-target", '"sin(t)"'

        def diverges(motion=1, axis=1, order=0):
            return lambda entry: entry.update(answer="violated", proof={"kind": "diverges", "motion": motion, "axis": axis, "order": order})
        for target in ("t*(2 + sin(t))", "t^4 - t*sin(t)", "-t", "exp(t) - 1", "t + sin(t*sin(t))", "t*min(sin(t), 0 - 1)",
                       "abs(t^2 - 3)", "abs(t - 3)*sin(t)", "exp(abs(t - 3))", "max(3, t)"):
            self.accepted(name, each, diverges(), (old, f'"{target}"'))
        # Each of these has a limit, or is zero. In the first the angle stands still, near a multiple of 2 π, wherever cos t > 0.1.
        stands = "(2*pi + t - atan(sin(t)/max(abs(cos(t)), 0.1)))"
        for target in (f"t*max(0, cos(t) - 0.1)*sin({stands}*(1 - exp(-t)))",
                       "t*sin(exp(-t))", "(pi - pi)*t*sin(t)", "t*abs(sin(2*t) - 2*sin(t)*cos(t))", "t*sin(t)*0",
                       "abs(t - 3) - t", "min(3, t)", "t - max(3, t)", "sqrt(1 + t)*cos(sqrt(1 + t)) - sqrt(1 + t)*cos(sqrt(1 + t))"):
            judged, found = self.judged(name, each, diverges(), (old, f'"{target}"'))
            self.assertNotIn(checker.ACCEPTED, [outcome for outcome, _ in judged], (target, found))
        self.assertTrue(checker.swings(checker.formula("1/(1 - cos(t))")), "without a value at first")
        grows = (old, '"t^3"')
        self.accepted(name, each, diverges(order=3), (old, '"t^4"'))
        # In the end it has no kink: the velocity of |t² − 3| grows, and that of |t − 3| does not.
        self.accepted(name, each, diverges(order=1), (old, '"abs(t^2 - 3)"'))
        self.rejected(name, each, "stays bounded", diverges(order=1), (old, '"abs(t - 3)"'))
        for motion, axis, words in ((0, 1, "is no motion"), (2, 1, "is no motion"), (1, 0, "is no axis"), (1, 2, "is no axis")):
            self.rejected(name, each, words, diverges(motion, axis), grows)
        points = "target.points = { times_s = [1, 2], positions = [[0], [1]] }"
        self.rejected(name, each, "is no axis with a formula", diverges(), ('target.formulas = ["sin(t)"]', points))
        # A derivative that no law reads: that of order four grows, those before it do not.
        fast = (old, '"sin(t^2)/(1 + t^2)^1.5"')
        self.rejected(name, each, "no derivative that a law uses", diverges(order=4), fast)
        self.rejected(name, each, "no derivative that a law uses", diverges(order=-1), grows)
        # Where those are that hear how fast a leader moves, or that agree, does not matter.
        self.rejected("formation", each, "no derivative that a law uses", diverges(), ("0.2*t + cos(0.3*t)", "0.3*t"))
        away = ("motion.sinusoids = [", 'motion.formulas = ["t", "0"]\n#'), ("    { offset = 0.3,", "#"), ("    { offset = -0.2,", "#"), ("\n]", "\n#")
        self.rejected("theorem-8", "bounded-leader", "no derivative that a law uses", diverges(), *away)

    def test_a_leader_that_is_an_agent_has_no_motion_of_which_something_is_known(self):
        holds = lambda **proof: lambda entry: entry.update(answer="holds", proof=proof)  # noqa: E731
        self.rejected("pilot-ship", "bounded-leader", "is of no motion", holds(kind="derivatives", order=3, stretch={"range": "for-ever"}))
        self.rejected("pilot-ship", "sign-gain", "is of no motion", holds(kind="bounds", bounds=[]))

    def test_one_of_several_agents_does_not_stand_for_the_others(self):
        """A claim that names two, with what is true of one of them."""
        near, far = place_of("theorem-6").read_text(), "formulas = [9, 9]"
        first, last = near.index("[[agents]]"), near.index("[reference.tracking]")
        other = near[first:last].replace('name = "arm"', 'name = "other"')
        both = other[:other.index("formulas")] + far + "\n"
        two = lambda entry: entry.update(agents=["arm", "other"])  # noqa: E731
        whole = ("[reference.tracking]", both + "\n[reference.tracking]")
        judged, found = self.judged("theorem-6", "target-within-reach", two, whole)
        self.assertNotIn(checker.ACCEPTED, [outcome for outcome, _ in judged], found)
        judged, found = self.judged("theorem-6", "target-within-reach", lambda entry: None, whole)
        self.assertIn((checker.ACCEPTED, "distance"), judged, found)
        text = place_of("theorem-7").read_text()
        craft = text[text.index("[[agents]]"):text.index("[reference.tracking]")]
        still = craft.replace('"craft"', '"other"').replace("[0, 0, 0, 1] ", "[0, 0, 0, 0] ")
        pair = lambda entry: entry.update(agents=["other", "craft"])  # noqa: E731
        judged, found = self.judged("theorem-7", "nonzero-quaternion", pair, ("[reference.tracking]", still + "[reference.tracking]"))
        self.assertNotIn(checker.ACCEPTED, [outcome for outcome, _ in judged], found)

    def test_swarms_whose_laplacian_changes(self):
        """One graph is definite, the other is not."""
        text = place_of("swarm-tracking").read_text()
        edges = text[text.index("edges = ["):text.index("[goal]")]
        phases = f"[[network.phases]]\ndwell_s = 1\n{edges}\n[[network.phases]]\ndwell_s = 1\nedges = []\n\n"
        self.rejected("swarm-tracking", "swarm-coupling", "a Laplacian that stays", lambda entry: None, (edges, phases))
        weight = ('["leader", "arm-1"]', '{ from = "leader", to = "arm-1", weight = "1.5 - cos(t)/3" }')
        self.rejected("swarm-tracking", "swarm-coupling", "a Laplacian that stays", lambda entry: None, weight)

    def test_what_the_coupling_of_a_swarm_must_exceed(self):
        """β + κ⁴/(2 (β² − α) (β − κ)), of roots and of coefficients; here 2 + 1/6, and of √0.14 more and less than 1.2."""
        def states(least):
            def spoil(entry):
                entry["proof"]["least"] = least
                shift = checker.Fraction(least) / 12
                rows = [[checker.Fraction(0)] * 6 for _ in range(6)]
                for k in range(6):
                    rows[k][k] = 2 + (k in (0, 3)) - shift
                    rows[k][k - 1] = rows[k - 1][k] = checker.Fraction(-1)
                entry["proof"]["pivots"] = [str(pivot) for pivot in checker.pivots(rows)]
            return spoil

        name, each, roots = "swarm-tracking", "swarm-coupling", "roots_per_s = [1.0, 1.0]"
        irrational, kappa = (roots, "alpha = 1.3\nbeta = 2.4"), 1.2 - math.sqrt(0.14)
        truth = 2.4 + kappa**4 / (2 * (2.4**2 - 1.3) * (2.4 - kappa))
        for change, least in ((), 2 + 1 / 6), ((irrational,), truth):
            self.accepted(name, each, states(f"{least + 1e-9:.12f}"), *change)
            self.rejected(name, each, "is too little for these roots", states(f"{least - 1e-9:.12f}"), *change)
        self.rejected(name, each, "is for real roots", lambda entry: None, (roots, "alpha = 1.5\nbeta = 2.4"))

    def test_what_a_formula_does_while_its_edge_is_not_there(self):
        """An edge that is there for a second, or in turns, is no witness of what it would do later; where it stays it is."""
        name, each = "formulas", "bounded-weights"
        text = place_of(name).read_text()
        network = text[text.index("[network]"):]
        agents = names_of(tomllib.loads(text))
        ring = [[a, b] for a, b in zip(agents, agents[1:] + agents[:1])]
        plain = f"edges = {json.dumps(ring)}\n"

        def phases(first, how):
            edges = f"edges = [{{ from = {json.dumps(ring[0][0])}, to = {json.dumps(ring[0][1])}, {first} }}]\n"
            return f'[network]\nswitching = "{how}"\n[[network.phases]]\ndwell_s = 1\n{edges}[[network.phases]]\n' + (
                "" if how == "once" else "dwell_s = 1\n") + plain

        def staying(first):
            formula = f"{{ from = {json.dumps(ring[0][0])}, to = {json.dumps(ring[0][1])}, {first} }}"
            return f"[network]\nedges = [{formula}, {json.dumps(ring[1:])[1:-1]}]\n"

        def violated(kind, **more):
            return lambda entry: entry.update(answer="violated", proof={"kind": kind, "edge": [*ring[0], 1], **more})

        for first, hypothesis, claim, comes_back in (
                ('weight = "exp(-t)"', each, violated("limit"), True), ('weight = "1 + t"', each, violated("limit"), False),
                ('weight = "1.2 - t"', each, violated("below", t_s="2"), False), ('delay.formula_s = "t"', "bounded-delays", violated("limit"), False)):
            self.rejected(name, hypothesis, "is not always there", claim, (network, phases(first, "once")))
            self.accepted(name, hypothesis, claim, (network, staying(first)))
            # What has a limit comes near to it whenever it comes back; of what grows the checker asks that it always is there.
            again = (name, hypothesis, claim, (network, phases(first, "repeat")))
            self.accepted(*again) if comes_back else self.rejected(name, hypothesis, "is not always there", *again[2:])
        swings, each = 'delay.formula_s = "abs(t*sin(t))"', "bounded-delays"
        self.accepted(name, each, violated("limit"), (network, staying(swings)))
        self.rejected(name, each, "is not always there", violated("limit"), (network, phases(swings, "repeat")))

        # While it is there it has bounds, from the start to the switch, and no longer.
        def stays(low, high, **more):
            within = {"range": "run", "cells": 8, "within": [low, high], "edge": [*ring[0], 1], **more}
            return lambda entry: entry.update(answer="holds", proof={"kind": "weights", "enclosures": [within]})

        each = "bounded-weights"
        for first, right, wrong in ('weight = "1 + t"', ("1", "2"), ("1", "1.99")), ('weight = "exp(-t)"', ("0.36", "1"), ("0.38", "1")):
            once = (network, phases(first, "once"))
            self.accepted(name, each, stays(*right), once)
            self.rejected(name, each, "does not hold", stays(*wrong), once)
            for lasts in phases(first, "repeat"), staying(first):
                self.assertNotIn(checker.ACCEPTED, [outcome for outcome, _ in self.judged(name, each, stays("1e-20", "100"), (network, lasts))[0]])

    def test_couplings_of_no_theorem(self):
        saturated = ("[network]", "[network]\ncoupling.saturated = 0.01\n")
        for name, each in (("theorem-8", "sign-gain"), ("theorem-2", "real-roots"), ("remark-12", "sign-gain")):
            self.rejected(name, each, "unlike it", lambda entry: None, saturated)

    def test_trees_of_every_phase(self):
        name, each = "theorem-3-24-order-4", "spanning-tree"
        path = [["arm-1", "arm-2"], ["arm-2", "arm-3"], ["arm-3", "own-roots"]]
        whole = "edges = " + json.dumps(path)
        same = [('edges = [["arm-1", "arm-2"], ["arm-3", "own-roots"]]', whole), ('edges = [["arm-2", "arm-3"]]', whole),
                ('edges = [["own-roots", "arm-1"], ["arm-2", "arm-1"]]', whole)]

        def windows(*runs):
            trees = [{"phases": list(run), "root": "arm-1", "arborescence": [[*edge, run[0]] for edge in path]} for run in runs]
            return lambda entry: entry.update(answer="holds", proof={"kind": "every-phase", "windows": trees})

        self.accepted(name, each, windows((1,), (2,), (3,)), *same)
        # Together is not each.
        self.rejected(name, each, "one for each phase", windows((1, 2), (3,)), *same)
        self.rejected(name, each, "is no edge", windows((1,), (2,), (3,)), *same[:2])

    def test_ages_of_messages(self):
        text = place_of("theorem-2").read_text()
        certificate = json.loads((self.folder / "theorem-2.json").read_text())
        certificate["hypotheses"].append({"id": "continuous-time", "agents": [], "answer": "not covered by the paper"})
        for bound, timeout, outcome in (("0.51", "0.51", checker.ACCEPTED), ("0.5", "0.6", checker.REJECTED), ("0.6", "0.55", checker.REJECTED)):
            proof = {"kind": "ages", "bound_s": bound}
            own = copy.deepcopy(certificate)
            own["hypotheses"].append({"id": "messages-in-time", "agents": [], "answer": "holds", "proof": proof})
            sampled_ = text.replace("[network]", f"[control]\nsample_hz = 100\nmessage_timeout_s = {timeout}\n[network]")
            found = checker.check(json.dumps(own), sampled_, SCENARIOS, digests=False)
            self.assertIn(("messages-in-time", outcome), [(one[0], one[3]) for one in found], found)

    def test_links_over_which_everything_is_too_old(self):
        text = place_of("theorem-2").read_text()
        certificate = json.loads((self.folder / "theorem-2.json").read_text())
        certificate["hypotheses"].append({"id": "continuous-time", "agents": [], "answer": "not covered by the paper"})
        sinusoid = "sinusoid = { mean_s = 0.25, amplitude_s = 0.25, period_s = 3.0 }"
        self.assertIn(sinusoid, text)

        def judged(delay, timeout, of=1, switching="repeat"):
            edge = ["arm-1", "arm-2", of]
            own = copy.deepcopy(certificate)
            own["hypotheses"].append({"id": "messages-in-time", "agents": [], "answer": "violated", "proof": {"kind": "older", "edge": edge}})
            sampled_ = f"[control]\nsample_hz = 100\nmessage_timeout_s = {timeout}\n[network]\nswitching = \"{switching}\""
            found = checker.check(json.dumps(own), text.replace(sinusoid, delay).replace("[network]", sampled_), SCENARIOS, digests=False)
            return next(one[3] for one in found if one[0] == "messages-in-time")

        link = "packets = { seed = 1, period_s = 0.1, latency_s = 0.3, jitter_s = 0.2 }"
        jumps = "piecewise_constant = { times_s = [0, 1], values_s = [0.3, 0.5], period_s = 2 }"
        for delay in ("constant_s = 0.3", sinusoid.replace("0.25, a", "0.55, a"), link, jumps, "saw_tooth = { min_s = 0.3, max_s = 0.5, period_s = 1 }",
                      "random_hold = { seed = 3, value_s = [0.3, 0.5], hold_s = [0.1, 0.8] }"):
            for timeout, outcome in (("0.29", checker.ACCEPTED), ("0.3", checker.REJECTED), ("0.31", checker.REJECTED)):
                self.assertEqual(judged(delay, timeout), outcome, (delay, timeout))
        # No edge of this phase, one that is gone, and what no rule tells.
        self.assertEqual(judged("constant_s = 0.3", "0.2", 2), checker.REJECTED)
        self.assertEqual(judged("constant_s = 0.3", "0.2", 1, "once"), checker.REJECTED)
        self.assertEqual(judged('formula_s = "0.3 + 0.01*sin(t)"', "0.2"), checker.REJECTED)

    def test_there_is_such_a_robot_whatever_is_asked_of_it(self):
        """Theorem 7 takes M = Mᵀ ≻ 0 for granted, (a8) a mass, and the others what no hypothesis of theirs names."""
        none = lambda entry: None  # noqa: E731
        rows = "inertia_kg_m2 = [[10, 0.5, -0.3], [0.5, 8, 0.2], [-0.3, 0.2, 6]]"
        for other in ("[[10, 0.5, -0.3], [0.5, -8, 0.2], [-0.3, 0.2, 6]]", "[[10, 0.5, -0.3], [0.7, 8, 0.2], [-0.3, 0.2, 6]]", "[10, 8, 0]", "-1",
                      "[[1, 2, 0], [2, 4, 0], [0, 0, 1]]", "[[1, 2, 0], [2, 3.99, 0], [0, 0, 1]]"):
            self.rejected("theorem-7", "attitude-gains", "no robot has", none, (rows, f"inertia_kg_m2 = {other}"))
        for other in ("[10, 8]", "[[10, 0.5], [0.5, 8]]"):
            self.rejected("theorem-7", "attitude-gains", "another number of entries", none, (rows, f"inertia_kg_m2 = {other}"))
        for other in ("[10, 8, 6]", "7", "[[1, 2, 0], [2, 4.01, 0], [0, 0, 1]]"):
            self.accepted("theorem-7", "attitude-gains", none, (rows, f"inertia_kg_m2 = {other}"))
        # A wheel without an axis, axes in a plane, and the momenta of other wheels.
        wheel = "{ axis = [0, 0, 1], torque_limit_n_m = 8"
        for axis in ("[0, 0, 0]", "[1, 1, 0]", "[0, 1]"):
            self.rejected("attitude-from-a-table", "attitude-gains", "no robot has", none, (wheel, wheel.replace("[0, 0, 1]", axis)))
        momenta = "wheel_momentum_n_m_s = "
        self.rejected("theorem-7", "attitude-gains", "no robot has", none, (momenta, momenta + "[0, 0, 0]\n# "))
        self.accepted("theorem-7", "attitude-gains", none, (momenta, momenta + "[0, 0, 0, 1]\n# "))
        for name, each, old, other, words in (
                ("without-velocity", "position-only-gains", "dimension = 3", "dimension = 0", "no robot has"),
                ("without-velocity", "position-only-gains", "dimension = 3", "dimension = 1.5", "no robot has"),
                ("without-velocity", "position-only-gains", "mass_kg = ", "mass_kg = -", "must be positive"),
                ("formation", "thrust-gains", "inertia_kg_m2 = [0.012, 0.012, 0.022]", "inertia_kg_m2 = [0.012, 0, 0.022]", "no robot has"),
                ("formation", "thrust-gains", "mass_kg = 1.2, ", "", "no robot has"),
                ("theorem-4", "thrust-gains", "mass_kg = ", "mass_kg = -", "must be positive"),
                ("theorem-2", "uniform-inertia", "length_m = [1.0, 0.8]", "length_m = [1.0, -0.8]", "must be positive"),
                ("theorem-2", "uniform-inertia", "length_m = [1.0, 0.8]", "length_m = [1.0, 0.8], damping = [0, -5]", "must not be negative"),
                ("theorem-2", "uniform-inertia", "length_m = [1.0, 0.8]", "length_m = [1.0, 0.8], gravity_m_s2 = -5", "must not be negative"),
                ("five-ships", "uniform-inertia", "surge_n_s_m = 12.0", "surge_n_s_m = -12.0", "must not be negative"),
                ("five-ships", "uniform-inertia", "sway_yaw_n_s = 0.4", "sway_yaw_n_s = 10", "no robot has"),
                ("planar-arms-with-friction", "smooth-friction", "coulomb = [0.6, 0.3]", "coulomb = [0.6, -0.3]", "must not be negative"),
                ("planar-arms-with-friction", "smooth-friction", "width = 0.05", "width = 0", "must be positive"),
                ("saturated-coupling", "input-factor", "order = 2", "order = 0", "no robot has")):
            self.rejected(name, each, words, none, (old, other))
        spread = lambda by: ("relative = 0.1", f"relative = {by}")  # noqa: E731
        for by in (100, 1, 0.91, -0.1): self.rejected("remark-12", "uniform-inertia", "vary by too much", none, spread(by))
        for by in (0, 0.9): self.accepted("remark-12", "uniform-inertia", none, spread(by))

    def test_starts_and_estimates_are_those_of_the_agents(self):
        none = lambda entry: None  # noqa: E731
        row = "[-0.6, -0.9], "
        for other in ("", row + row): self.rejected("theorem-2", "uniform-inertia", "another number of starts", none, (row, other))
        adaptive = ("[law.adaptive]", "[law.adaptive]\nestimate_start.given = [%s]")
        self.accepted("theorem-2", "uniform-inertia", none, (adaptive[0], adaptive[1] % "1, 2, 3, 4, 5"))
        self.rejected("theorem-2", "uniform-inertia", "not all estimates", none, (adaptive[0], adaptive[1] % "1, 2"))

    def test_laws_go_with_the_references_that_they_are_made_for(self):
        """Neither a law that follows targets agrees, nor does one that hears positions alone hear velocities; and few roots lead no chain."""
        words, none = "does not go with these reference dynamics", lambda entry: None
        position, velocity = 'exchange = "position"', 'exchange = "position_velocity"'
        for name in ("saturated-coupling", "theorem-4"):
            self.rejected(name, "applied-torque", words, none, (position, velocity))
            self.rejected(name, "applied-torque", words, none, ("[reference.consensus]", "[reference.pure_integral]"))
        self.rejected("saturated-coupling", "applied-torque", words, none, ("order = 2", "order = 9"))
        for name, roots, few in (("theorem-1", "[1.0, 2.0]", "[1.0]"), ("without-velocity", "[1.0, 1.5, 2.0]", "[1.0, 1.5]"),
                                 ("model-reference", "[1.0, 2.0]", "[1.0]")):
            self.rejected(name, "applied-torque", words, none, (f"roots_per_s = {roots}", f"roots_per_s = {few}"))
        self.rejected("desired-nonlinear-arms", "applied-torque", words, none, ("\npolynomial = [0, 2]", "\npolynomial = [0]"))

    def test_delays_jump_at_times_that_rise(self):
        none = lambda entry: None  # noqa: E731
        jumps = "times_s = [0, 0.37, 0.9]"
        for other in ("[0, 0.9, 0.37]", "[0.1, 0.37, 0.9]", "[0, 0.37, 0.37]", "[0, 0.37]", "[0, 0.37, 99]"):
            self.rejected("theorem-2", "bounded-delays", "must rise", none, (jumps, f"times_s = {other}"))
        self.accepted("theorem-2", "bounded-delays", none, (jumps, "times_s = [0, 0.38, 0.9]"))
        for other in ("[0, 0.3]", "[0.3, 0.1]", "[0.1, 0.2, 0.3]"):
            self.rejected("leader-over-late-links", "bounded-delays", "must rise", none, ("hold_s = [0.1, 0.3]", f"hold_s = {other}"))
        self.accepted("leader-over-late-links", "bounded-delays", none, ("hold_s = [0.1, 0.3]", "hold_s = [0.3, 0.3]"))

    def test_everybody_that_agrees_needs_roots(self):
        rootless = ("reference.consensus = { roots_per_s = [1.5] }\n", "")
        self.rejected("framework", "real-roots", "has no roots", lambda entry: None, rootless)

    def test_orders_of_their_own_need_roots_of_everybody(self):
        agents = lambda *roots: type("Scenario", (), {"agents": [type("Agent", (), {"roots": own}) for own in roots]})  # noqa: E731
        for roots, right in ((([1],), True), (([1], [1, 2]), True), (([1], []), False)):
            self.assertEqual(checker.TEXT["own-orders", "text"](agents(*roots), []), right, roots)

    def test_each_root_of_everybody_counts(self):
        """Also one that stands behind a larger first root."""
        for other, bound in (("-3", "1"), ("0.5", "1"), ("0.5", "0.51")):
            behind = ("reference.consensus = { roots_per_s = [1.5] }", f"reference.consensus = {{ roots_per_s = [1.5, {other}] }}")
            self.rejected("framework", "real-roots", "below all roots", lambda entry: entry["proof"].update(value=bound), behind)
        behind = ("reference.consensus = { roots_per_s = [1.5] }", "reference.consensus = { roots_per_s = [1.5, 0.5] }")
        self.accepted("framework", "real-roots", lambda entry: entry["proof"].update(value="0.5"), behind)

    def test_the_third_derivative_of_a_curve_through_points_jumps(self):
        points = ('target.formulas = ["0.2*t + cos(0.3*t)", "sin(0.3*t)", "-0.5"]', "target.points = { times_s = [1, 2], positions = [[0, 0, 0], [1, 1, 1]] }")
        judged, found = self.judged("formation", "bounded-target", lambda entry: None, points)
        self.assertIn((checker.UNCHECKED, "a curve's third derivative jumps"), judged, found)

    def test_shares(self):
        def said(*shares):
            certificate = json.loads((self.folder / "first-order.json").read_text())
            certificate["agreement"]["influence"] = [[f"arm-{k + 1}", share] for k, share in enumerate(shares)]
            found = checker.check(json.dumps(certificate), place_of("first-order").read_text(), SCENARIOS, digests=False)
            return [one[4] for one in found if one[3] == checker.REJECTED]

        self.assertEqual(said("1/4", "0.25", "1/4", "1/4"), [])
        self.assertEqual(said("1/2", "1/2", "1/2", "1/2"), ["must be shares of one"])
        self.assertEqual(said("1/2", "1/4", "1/8", "1/8"), ["is no left null vector of the Laplacian"])
        self.assertEqual(said("1/4", "1/4", "1/2"), ["must be [agent, share] of everybody"])
        twice = json.loads((self.folder / "first-order.json").read_text())
        twice["agreement"]["influence"].insert(0, ["arm-1", "1/2"])
        found = checker.check(json.dumps(twice), place_of("first-order").read_text(), SCENARIOS, digests=False)
        self.assertEqual([one[4] for one in found if one[3] == checker.REJECTED], ["must be [agent, share] of everybody"])
        # A tree that is claimed for the run alone is the same tree, since the graph never changes.
        weaker = json.loads((self.folder / "first-order.json").read_text())
        weaker["hypotheses"][0]["answer"] = "holds on [0, end]"
        found = checker.check(json.dumps(weaker), place_of("first-order").read_text(), SCENARIOS, digests=False)
        self.assertIn(("agreement", checker.ACCEPTED), [(one[0], one[3]) for one in found])
        # A tree that is not shown is none, and no graph of several is that of a fixed network: whom arm-k hears counts in one of them.
        weaker["hypotheses"][0].update(answer="not shown")
        del weaker["hypotheses"][0]["proof"]
        found = checker.check(json.dumps(weaker), place_of("first-order").read_text(), SCENARIOS, digests=False)
        self.assertIn("is of a network whose spanning tree is not shown", [one[4] for one in found])
        text, certificate = place_of("theorem-2").read_text(), json.loads((self.folder / "theorem-2.json").read_text())
        graph = checker.Scenario(text, SCENARIOS).graphs[0]
        alone = min(set(range(6)) - {edge.to for edge in graph})
        certificate["agreement"] = {"influence": [[f"arm-{k + 1}", str(int(k == alone))] for k in range(6)]}
        found = checker.check(json.dumps(certificate), text, SCENARIOS, digests=False)
        self.assertIn("is of no fixed network", [one[4] for one in found])
        varying = ("[network]", '[network]\nweight = "2 + sin(t)"')
        text = place_of("first-order").read_text().replace(*varying)
        found = checker.check((self.folder / "first-order.json").read_text(), text, SCENARIOS, digests=False)
        self.assertIn("is of no fixed network", [one[4] for one in found])
        # Of two closed classes each has a null vector, and no value is agreed upon.
        text = place_of("cut").read_text()
        text = text[:text.index("[[network.phases]]")] + 'edges = [["mass-1", "mass-2"], ["mass-3", "mass-4"]]\n'
        certificate = json.loads((self.folder / "cut.json").read_text())
        certificate["agreement"] = {"influence": [["mass-1", "1"], ["mass-2", "0"], ["mass-3", "0"], ["mass-4", "0"]]}
        found = checker.check(json.dumps(certificate), text, SCENARIOS, digests=False)
        self.assertIn("is of a network whose spanning tree is not shown", [one[4] for one in found])


class Hostile(unittest.TestCase):
    """Nothing crashes the checker, and nothing malformed is accepted."""

    SCENARIO = place_of("theorem-2").read_text()

    def reject(self, certificate, scenario=None):
        accepted, rejected, found = outcomes(certificate, scenario or self.SCENARIO)
        self.assertTrue(rejected, (certificate[:200], found))

    def test_documents_that_are_none_are_rejected(self):
        deep = "[" * 100_000
        for text in ("", "{", "[]", "7", "null", '"x"', deep, "{\"a\":" * 5000, '{"format": NaN}', '{"format": Infinity}',
                     '{"format": 1.0}', '{"format": 1, "format": 1}', '{"format": ' + "9" * 6000 + "}", "\u0000", '{"format": true}'):
            self.reject(text)

    def test_fields_that_are_missing_or_of_another_type_are_rejected(self):
        folder = Path(os.environ["FORWARDSTEP_CERTIFICATES"])
        whole = json.loads((folder / "theorem-2.json").read_text())
        free = ("producer", "scenario")
        for path in [path for path in nodes(whole) if path and path[0] not in free]:
            for value in (None, True, 3.5, -1, "", "9" * 5000, "1/0", "1e999", [], {}, [[]], {"kind": "none"}):
                spoilt = copy.deepcopy(whole)
                held = spoilt
                for key in path[:-1]:
                    held = held[key]
                if held[path[-1]] == value and type(held[path[-1]]) is type(value):
                    continue
                held[path[-1]] = value
                self.reject(json.dumps(spoilt))

    def test_scenarios_without_meaning_are_rejected(self):
        folder = Path(os.environ["FORWARDSTEP_CERTIFICATES"])
        certificate = (folder / "theorem-2.json").read_text()
        changes = {"end_s = 100": "end_s = nan", "weight = 1.0": "weight = 1e999999999", "count = 6": "count = 10000000000",
                   "mean_s = 0.25": "mean_s = -inf", "dwell_s = 1.0": "dwell_s = -1.0", "roots_per_s = [1.0, 2.0]": "roots_per_s = 1",
                   "format = 2": "format = [" + "[" * 5000, "edges = [[": "edges = [[7, ", "[law.adaptive]": "[law.adaptive.damping]"}
        for old, new in changes.items():
            self.assertIn(old, self.SCENARIO)
            self.reject(certificate, self.SCENARIO.replace(old, new, 1))
        for name in ("x" * 300 + ".csv", "wide.csv"):
            with tempfile.TemporaryDirectory() as place:
                Path(place, "wide.csv").write_text("from,to\n" + "a" * 200_000 + ",b\n")
                text = self.SCENARIO.split("[network]")[0] + f'[network]\nedges.csv = {{ file = "{name}" }}\n'
                found = checker.check(certificate, text, Path(place))
                self.assertEqual(found[-1][3], checker.REJECTED, found)
        self.reject(certificate, self.SCENARIO.replace("weight = 1.0", 'weight = "' + "(" * 3000 + "t" + ")" * 3000 + '"'))


def nodes(value, path=()):
    """Places of everything in a document."""
    yield path
    if isinstance(value, (dict, list)):
        for key, entry in value.items() if isinstance(value, dict) else enumerate(value):
            yield from nodes(entry, (*path, key))


MASSES = """format = 2
time.end_s = 10
[[agents]]
name = "m"
count = {count}
robot.point_mass = {{ dimension = 1, mass_kg = 2 }}
start.position_m = [0]
[law.known]
[reference]
{reference}
"""


class Enclosures(unittest.TestCase):
    """Enclosures hold what floating point finds, and are narrow."""

    def test_functions_are_enclosed(self):
        draw = random.Random(3)
        ranges = {"sin": (-90, 90), "cos": (-90, 90), "exp": (-20, 20), "log": (1e-6, 1e6), "sqrt": (0, 1e6), "tanh": (-9, 9), "atan": (-50, 50)}
        for name, (low, high) in ranges.items():
            for _ in often(100):
                x = checker.Fraction(draw.uniform(low, high))
                found = checker.function(name, (x, x))
                value = getattr(math, name)(float(x))
                self.assertLessEqual(found[0], found[1])
                self.assertLess(found[1] - found[0], 1e-25 * max(1, abs(value)))
                self.assertAlmostEqual(float(found[0]) / max(1, abs(value)), value / max(1, abs(value)), 12)

    def test_no_number_is_rounded_on_the_way(self):
        """A crest inside is a rational number like all others, of which there are inverses and powers."""
        for text, expected in (("1/cos(sin(t))", (1, 1 / math.cos(1))), ("cos(sin(t))^-2", (1, math.cos(1) ** -2)), ("pi/cos(sin(t))", (math.pi, math.pi / math.cos(1))),
                               ("cos(pi + sin(t))^-1", (-1 / math.cos(1), -1)), ("1/cos(sin(t)) - 1 + exp(-t)", (0, 1 / math.cos(1) - 1 + math.exp(-1)))):
            found = checker.enclose(checker.formula(text), checker.LATE)
            self.assertTrue(all(type(end) is checker.Fraction for end in found), text)
            for end, true in zip(found, expected): self.assertAlmostEqual(float(end), true, 9, text)
        self.assertRaises(checker.Undecided, checker.infinite, 1.0)

    def test_what_would_take_hours_or_all_memory_is_not_decided(self):
        for text in ("((2^1000)^1000)^1000", "1 + tanh((((t/9)^1000)^1000)^1000)", "(1 + t)^1025"):
            self.assertRaises(checker.Undecided, checker.enclose, checker.formula(text), (checker.Fraction(1), checker.Fraction(2)))
        tree = checker.formula("sin(t)*cos(2*t)*sin(3*t)*sin(5*t)")
        with self.assertRaises(checker.Undecided):
            for _ in range(9): tree = checker.derivative(tree)
        for phases, refused in ((1, False), (3, True)):
            text = MASSES.format(count=580, reference="consensus.roots_per_s = [1, 2]\nconsensus.exchange = \"position\"")
            text += "[network]\ndelay.constant_s = 0.1\n" + "[[network.phases]]\ndwell_s = 1.0\nedges.complete = {}\n" * phases
            if refused:
                with self.assertRaisesRegex(checker.Meaningless, "too many edges"): checker.Scenario(text, Path(), ())
            else: self.assertEqual(len(checker.Scenario(text, Path(), ()).graphs[0]), 580 * 579)

    def test_a_desired_design_is_one_whatever_root_stands_first(self):
        """κ₀ is the root that the velocity which is heard is divided by."""
        for heard, known in (("", [1, 2]), ("[2]", [1, 2]), ("[2, 2]", [1, 2]), ("[2, 1]", [2, 1]), ("[2, 3]", None), ("[3]", None), ("[2, 1, 1]", None)):
            own = 'polynomial = { integrators = 1, roots_per_s = [1, 2] }\ncoupling_polynomial.roots_per_s = [2, 1]\n'
            text = MASSES.format(count=2, reference=f"desired = {{ {own.strip().replace(chr(10), ', ')}{f', heard = {heard}' if heard else ''} }}")
            scenario = checker.Scenario(text + "[network]\nedges.ring = {}\n", Path(), ())
            self.assertEqual(scenario.desired, known is not None, heard)
            if known: self.assertEqual([kappa for kappa, _ in scenario.agents[0].roots], known, heard)

    def test_functions_are_enclosed_to_sixty_digits(self):
        """Held against `decimal`, and series in it."""
        draw, exact = random.Random(9), decimal.Context(prec=160)

        def series(term, step):
            total, k = decimal.Decimal(0), 1
            while abs(term) > decimal.Decimal("1e-150"):
                total, term, k = exact.add(total, term), exact.multiply(term, step(k)), k + 1
            return total

        def atan(x):
            if abs(x) > decimal.Decimal("0.1"):
                return 2 * atan(exact.divide(x, exact.add(1, exact.sqrt(exact.fma(x, x, 1)))))
            square, total, term, k = exact.multiply(x, x), decimal.Decimal(0), x, 1
            while abs(term) > decimal.Decimal("1e-150"):
                total, term, k = exact.add(total, exact.divide(term, k)), exact.minus(exact.multiply(term, square)), k + 2
            return total

        def value(name, x):
            square = exact.minus(exact.multiply(x, x))
            match name:
                case "sin": return series(x, lambda k: exact.divide(square, 2 * k * (2 * k + 1)))
                case "cos": return series(decimal.Decimal(1), lambda k: exact.divide(square, 2 * k * (2 * k - 1)))
                case "exp": return exact.exp(x)
                case "log": return exact.ln(x)
                case "sqrt": return exact.sqrt(x)
                case "tanh": return 1 - exact.divide(2, exact.add(1, exact.exp(2 * x)))
                case "atan": return atan(x)

        with decimal.localcontext(exact):
            ranges = {"sin": (-30, 30), "cos": (-30, 30), "exp": (-90, 90), "log": (1e-6, 1e6), "sqrt": (0, 1e6), "tanh": (-9, 9), "atan": (-50, 50)}
            for name, (low, high) in ranges.items():
                for _ in often(60):
                    x = checker.Fraction(draw.choice((draw.uniform(low, high), draw.uniform(0.4, 2.1), round(draw.uniform(1, 9)))))
                    a, b = (decimal.Decimal(end.numerator) / end.denominator for end in checker.function(name, (x, x)))
                    true = value(name, decimal.Decimal(x.numerator) / x.denominator)
                    room = max(abs(true), 1) * decimal.Decimal("1e-120")
                    self.assertTrue(a - room <= true <= b + room, (name, x))
                    self.assertLess(b - a, max(abs(true), 1) * decimal.Decimal("1e-40"), (name, x))
        # Just below a square, and squares.
        for x in (1 - checker.Fraction(1, 2**2000), checker.Fraction(1, 4), checker.Fraction(2), checker.Fraction(10**50 + 1)):
            a, b = checker.sqrt_at(x)
            self.assertTrue(a * a <= x <= b * b and b - a <= 2**-300 * max(1, b), x)
        for x in (checker.Fraction(0), checker.Fraction(1, 4), checker.Fraction(49, 4)): self.assertEqual(len({*checker.sqrt_at(x)}), 1, x)
        # What has no double is still on the stated side.
        for x in (-2000, -1501, 1501, 2000):
            a, b = checker.exp_at(checker.Fraction(x))
            self.assertTrue(0 <= a < b and (a >= 2**2000 if x > 0 else b <= checker.Fraction(1, 2**2000)), x)

    def test_uniform_continuity_is_not_taken_for_granted(self):
        for text, expected in (("sin(t)*cos(t)", True), ("0.2*t + 1", True), ("exp(-abs(sin(t)))", True), ("t*sin(t)", False),
                               ("sin(t^2)", False), ("exp(t)", False), ("t^3", False), ("t/(1 + t)", True), ("max(1, min(t, 3))", True),
                               ("2 - exp(-t)", True), ("t^2/(1 + t)", True), ("t^3/(1 + t)", False), ("sqrt(t)*sin(t)", False),
                               ("min(sqrt(t), 1)", True), ("min(sqrt(t), abs(sin(t)))", True), ("tanh(t^2)", True), ("t*exp(-t)", True),
                               ("exp(-t^2)*sin(t)", True), ("sin(t^2)/(1 + t)", True), ("sin(sqrt(t)) + cos(t)^2", True), ("log(2 + sin(t))", True),
                               ("min(1, abs(t*sin(t)))", False), ("sin(exp(t))", False), ("tanh(t*sin(t))", False), ("sin(t)*sin(t^2)", False),
                               ("tanh(t^2)*sin(t^2)", False), ("abs(sin(t*sin(t)))", False), ("sqrt(1 + t^2)", True), ("sqrt((t + sin(t))^2 + 2)", True),
                               ("sqrt(1 + t + t^2)", True), ("sqrt(1 + t)*cos(sqrt(1 + t))", True), ("sin(sqrt(2 + (t - 3)^2)*t)", False),
                               ("sqrt(2 + (t - 3)^2)/(1 + t)", True), ("sqrt(1 + t)*cos(t)", False), ("sqrt(1 + (t^2)^2)", False), ("sqrt(1 + t^3)", False), ("sqrt(1 + sqrt(2 + t)^2)", True),
                               # What tends to ∞, or to zero, above and below a line tells nothing of the quotient.
                               ("((t + 1)*(2 + sin(t^2)))/(t + 1)", False), ("(exp(-t)*(2 + sin(t^2)))/exp(-t)", False),
                               ("(t + 1)*((2 + sin(t^2))/(t + 1))", False), ("(t + 1)*(2 + sin(t^2)) - (t + 1)*sin(t^2) - 2*t", False),
                               ("(t + sin(t^2)) - t", False), ("(t + sin(t^2)) + (1 - t)", False), ("(sin(t^2)/t)/(1/t)", False),
                               ("1/cos(sin(t))", True), ("(1 + t)^-1*(1 + exp(-t))", True), ("t^2*(2 + exp(-t))", False)):
            tree = checker.formula(text)
            for start in (checker.LATE, checker.FOR_EVER): self.assertEqual(checker.steady(tree, start), expected, text)

    def test_slopes_are_those_of_differences(self):
        for text in ("atan(t)", "atan(sin(2*t) - t)", "atan(exp(-t))", "sqrt(1 + t^2)", "sqrt(0.3 + (sin(1.7*t) - t)^2)",
                     "sqrt((1 - 2*t)^2 + 2)", "sqrt(9 + t^2)/(1 + t)", "tanh(t)/(2 + cos(t))", "t^2/3", "3/(1 + t)", "log(2 + t)*exp(-t)"):
            tree = checker.formula(text)
            slope, moved = checker.derivative(tree), checker.Fraction(1, 10**6)
            for t in (checker.Fraction(k, 3) for k in range(1, 12)):
                after, before = (checker.enclose(tree, (at, at)) for at in (t + moved, t - moved))
                self.assertAlmostEqual(float(checker.enclose(slope, (t, t))[0]), float((after[0] - before[0]) / (2 * moved)), 9, f"{text} at {t}")

    def test_limits_are_those_of_calculus(self):
        half = math.pi / 2
        for text, expected in (("t/(1 + t)", (1, 1)), ("(3*t^2 - t)/(2*t^2 + 5)", (1.5, 1.5)), ("1/log(t + 3)", (0, 0)), ("exp(-t)*sin(5*t)", (0, 0)),
                               ("1 - 0.01*t", (-math.inf, -math.inf)), ("sqrt(t)", (math.inf, math.inf)), ("atan(-t)", (-half, -half)),
                               ("tanh(t)", (1, 1)), ("2 + sin(t^2)", (1, 3)), ("t - t^2/(1 + t)", (1, 1)), ("min(t, 3)", (3, 3)),
                               ("t^1.5", (math.inf, math.inf)), ("(1 + t)^-0.5", (0, 0)), ("(2 + sin(t))^1.5", (1, 3**1.5)),
                               ("t*(2 + sin(t))", (math.inf, math.inf)), ("(t - 3)/(t - 3)", (1, 1)),
                               ("abs(-t)", (math.inf, math.inf)), ("(-t)^3", (-math.inf, -math.inf)), ("t^-2", (0, 0)), ("exp(0 - t)", (0, 0)),
                               ("t*exp(-t)", (0, 0)), ("t^3*exp(-t^2)*sin(t)", (0, 0)), ("t/(1 + abs(1 - t))", (1, 1)),
                               ("3*sin(t) + 4*cos(t)", (-5, 5)), ("sqrt(t)*(1/t)", (0, 0)), ("sqrt(2 + (t - 3)^2)/(1 + t)", (1, 1)),
                               ("-t/sqrt(1 + 4*t^2)", (-0.5, -0.5)), ("(1 - t)*(1 + t^2)^-0.5", (-1, -1)), ("sqrt(1 + t)^-2*t", (1, 1)),
                               ("sqrt(t)/sqrt(1 + t)*cos(t)", (-1, 1)), ("t/sqrt(1 + t)", (math.inf, math.inf))):
            found = checker.limit(checker.formula(text))
            self.assertEqual([round(float(end), 12) for end in found], [round(end, 12) for end in expected], text)
        for text in ("sqrt(t) - t", "t*exp(t)*0", "t*sin(t)", "exp(-t)*exp(2*t)", "abs(-1/t)*t", "t*min(0, -1/t)", "exp(t)/t", "log(-t)", "t/(t - t)", "0*exp(t)",
                     "sqrt(1 - t)/t", "sqrt(1 - t)*sqrt(1 - t)/t^2", "sqrt(t)*sin(t)", "log(t)*sqrt(t)/t"):
            self.assertRaises(checker.Undecided, checker.limit, checker.formula(text))

    def test_what_is_found_from_a_time_on_holds_samples(self):
        """Of drawn formulas: from 1 s on, in the limit, and on pieces from the middle on by the slope."""
        draw, bounded = random.Random(11), 0
        leaves = ("t", "sin(t)", "cos(t)", "sin(2*t)", "exp(-t)", "exp(-t^2/4)", "1/(1 + t^2)", "(1 - t)", "2", "0.3", "t^2", "sqrt(1 + t)",
                  "sqrt(2 - t + t^2)", "(1 + t)^-0.5")

        def drawn(depth):
            if depth == 0 or draw.random() < 0.15: return draw.choice(leaves)
            a, b = drawn(depth - 1), drawn(depth - 1)
            return draw.choice((f"({a} + {b})", f"({a} - {b})", f"{a}*{b}", f"{a}*{b}", f"{a}/(1 + abs({b}))", f"abs({a})", f"min({a}, {b})",
                                f"max({a}, {b})", f"tanh({a})", f"cos({a})", f"{a}/(1.5 + sin({b}))", f"cos(sin({a}))^-1", f"1/cos(tanh({a}))"))

        for _ in often(150):
            text = drawn(3)
            tree = checker.formula(text)
            value = lambda t, text=text: eval(text.replace("^", "**"), {"t": t, **vars(math)})  # noqa: E731
            within, late = checker.attempt(checker.enclose, tree, checker.LATE), checker.attempt(checker.limit, tree)
            room = lambda x: 1e-9 * (1 + abs(x))  # noqa: E731
            for t in [1 + 0.37 * k for k in range(80)] + [1e3, 12345.6] if within else ():
                x = value(t)
                self.assertTrue(within[0] - room(x) <= x <= within[1] + room(x), f"{text} at {t}: {x}")
            bounded += within is not None and not any(map(checker.infinite, within))
            if late and checker.settles(tree) and not checker.infinite(late[0]):
                self.assertLess(abs(value(1e7) - float(late[0])), 1e-3 * (1 + abs(value(1e7))), text)
            piece = (checker.Fraction(3), checker.Fraction(13, 4))
            straight = checker.attempt(checker.straight, tree, piece)
            for t in [3 + k / 80 for k in range(21)] if straight else ():
                self.assertTrue(straight[0] - room(value(t)) <= value(t) <= straight[1] + room(value(t)), f"{text} at {t}")
        self.assertGreater(bounded, len(often(60)))

    def test_roots_are_bounded_by_their_squares(self):
        """From a time on; with the sign where the factors have one, and no value where one of them has none."""
        sixteen, one = (checker.Fraction(16), checker.INF), checker.LATE
        for text, t, expected in (("sqrt(t^2 + 3)/t", one, (1, 2)), ("-sqrt(t^2 + 3)/t", one, (-2, -1)), ("t/sqrt(t^2 + 3)", one, (0.5, 1)),
                                  ("(t^2 + 3)^-0.5*t", one, (0.5, 1)), ("sqrt(t^2 + 3)^-2*t^2", one, (0.25, 1)), ("1/sqrt(t)", sixteen, (0, 0.25)),
                                  ("sqrt(t^2 + 3)/t*cos(t)", one, (-2, 2)), ("(1 - 2*t)/sqrt(t^2 + 3)", one, (-2, -0.5)),
                                  ("sqrt(t)*exp(-t)", one, (-1 / math.e, 1 / math.e)), ("(1 + t)^1.5/t^2", one, (0, math.sqrt(8)))):
            low, high = map(float, checker.enclose(checker.formula(text), t))
            exact = low >= expected[0] - 1e-9 and high <= expected[1] + 1e-9 and min(abs(low - expected[0]), abs(high - expected[1])) < 1e-9
            self.assertTrue(exact, (text, low, high))
        # A square is not below zero, whatever encloses it, and polynomials that belong together stay so when sums are multiplied out.
        for text in ("sqrt(2 + (t - 3)^2)/(1 + t)", "((t - t^2/(1 + t))*sin(t) + sqrt(1 + t))/sqrt(1 + t)"):
            self.assertLess(checker.enclose(checker.formula(text), one)[1], 4, text)
        # (t − 2)/√(t² + 3) is negative at first, and √(t − 5) has no value there: neither has its square, though (t − 5) is taken twice.
        self.assertLessEqual(checker.enclose(checker.formula("(t - 2)/sqrt(t^2 + 3)"), one)[0], -0.5)
        for text in ("sqrt(t - 5)/t", "sqrt(t - 5)*sqrt(t - 5)/t", "(t - 5)^0.5/t", "1/sqrt(t - 20)", "t/sqrt(t - 20)^2", "sqrt(t - 20)/(t - 20)"):
            self.assertRaises(checker.Undecided, checker.enclose, checker.formula(text), sixteen if "20" in text else one)
        for text in ("sqrt(1 + t)*sin(t)", "sqrt(1 + t^3)/t", "t^1.5/(1 + t)"):
            self.assertTrue(checker.infinite(checker.enclose(checker.formula(text), one)[1]), text)

    def test_quotients_of_polynomials_keep_within_what_they_take(self):
        """A polynomial in 1/t by its coefficients of Bernstein: 1 − u + u² stays positive from 1 s on."""
        self.assertEqual(checker.by_quotient(checker.formula("(t^2 - t + 1)/t^2"), checker.LATE), (checker.Fraction(1, 2), 1))
        draw = random.Random(5)
        for _ in often(200):
            p, end = [checker.Fraction(draw.randint(-9, 9), draw.randint(1, 4)) for _ in range(draw.randint(1, 7))], checker.Fraction(draw.randint(0, 6), 3)
            low, high = checker.held(p, end)
            values = [sum(c * (end * k / 40) ** n for n, c in enumerate(p)) for k in range(41)]
            self.assertTrue(low <= min(values) and max(values) <= high, (p, end))
            self.assertTrue({values[0], values[-1]} <= {low, high} or len(p) > 2, (p, end))

    def test_quotients_keep_their_poles(self):
        for text in ("1/(1/(t - 20))", "(1/(t - 20))^-1", "0*(1/(t - 20)) + 1", "(1/(t - 20))^0", "2 + (1/(t - 20))^0"):
            self.assertRaises(checker.Undecided, checker.enclose, checker.formula(text), (checker.Fraction(16), checker.INF))
        late = checker.enclose(checker.formula("t/(1 + t)"), (checker.Fraction(16), checker.INF))
        self.assertEqual(late, (checker.Fraction(16, 17), 1))

    def test_roots_of_what_is_negative_have_no_value(self):
        """Of any broken exponent, and of zero where it is negative; where a base may be either, nothing is said."""
        number = lambda x: (checker.Fraction(x),) * 2  # noqa: E731
        for text, x in (("x^0.5", -1), ("x^1.5", "-1/4"), ("x^-0.5", 0), ("x^-0.5", -2), ("(x - 1)^(1/3)", 0), ("1 + (0 - x^2)^0.25", 3)):
            self.assertRaises(checker.Undefined, checker.enclose, checker.formula(text, ["x"]), {"x": number(x)})
        for text, t in (("x^0.5", (-1, 1)), ("x^-0.5", (0, 1)), ("x^0.5", (-1, 0)), ("x^-1.5", (-1, 1))):
            with self.assertRaises(checker.Undecided) as raised: checker.enclose(checker.formula(text, ["x"]), {"x": tuple(map(checker.Fraction, t))})
            self.assertIs(type(raised.exception), checker.Undecided, text)
        self.assertEqual(checker.enclose(checker.formula("x^0.5", ["x"]), {"x": number(0)}), (0, 0))

    def test_zero_times_what_has_no_value_is_not_zero(self):
        for text in ("0*log(t - 5)", "0/(t - 5)", "0*(t - 5)^-1", "0*sqrt(t - 5)"):
            slope = checker.derivative(checker.formula(text))
            self.assertRaises(checker.Undecided, checker.enclose, slope, (checker.Fraction(0), checker.Fraction(10)))
        # Nor has a sum with a number that is none a slope.
        for text in ("t + 1/0", "t + log(0 - 1)", "0*t/0 + t", "t*(1/0)^0"):
            self.assertRaises(checker.Undecided, checker.derivative, checker.formula(text))

    def test_curves_are_those_that_are_defined(self):
        """Through the points, at rest at both ends, four derivatives that agree inside; what they keep within holds samples."""
        draw, rate = random.Random(6), lambda p, n: p if n == 0 else rate([k * c for k, c in enumerate(p)][1:], n - 1)
        at = lambda p, x: sum(c * x**k for k, c in enumerate(p))  # noqa: E731
        for count in (1, 2, 3, 4, 7):
            times = tuple(checker.Fraction(draw.randrange(10 * k, 10 * k + 9), 10) for k in range(count))
            values = tuple(checker.Fraction(draw.randrange(-50, 50), 10) for _ in times)
            first, *inside, last = checker.curve(times, values)
            self.assertEqual((first, last), ((-checker.INF, times[0], [values[0]]), (times[-1], checker.INF, [values[-1]])))
            ends = [[at(rate(piece, n), x) for n in range(5)] for start, end, piece in inside for x in (0, end - start)]
            self.assertEqual([(start, end) for start, end, _ in inside], list(zip(times, times[1:])))
            self.assertEqual([one[0] for one in ends[::2]] + [one[0] for one in ends[-1:]], list(values[:None if inside else 0]))
            self.assertEqual([end[1:3] for end in ends[:1] + ends[-1:]], [[0, 0]] * (2 if inside else 0))
            self.assertEqual(ends[1:-1:2], ends[2::2])
            for order in range(4):
                drawn = [checker.Fraction(draw.randrange(-20, 80), 10) for _ in range(20)]
                for low, high in [(low, low + checker.Fraction(draw.randrange(30), 10)) for low in drawn] + list(zip(times, times)):
                    found = checker.enclose(("points", times, values, order), (low, high))
                    for x in (low + (high - low) * k / 20 for k in range(21)):
                        pieces = [one for one in checker.curve(times, values) if one[0] <= x <= one[1]]
                        sampled_ = [at(rate(piece, order), 0 if start == -checker.INF else x - start) for start, _, piece in pieces]
                        self.assertTrue(all(found[0] <= value <= found[1] for value in sampled_), (times, values, order, low, high))
        self.assertRaises(checker.Undecided, checker.curve, tuple(range(400)), (checker.Fraction(1),) * 400)

    def test_periods_are_those_of_all_waves(self):
        for text, unit, length in (("sin(2*t)", math.pi, 1), ("sin(2*t) + cos(3*t/2)", math.pi, 4), ("sin(pi*t) + 1", 1, 2), ("cos(2*pi*t/3)*sin(pi*t/4)", 1, 24),
                                   ("abs(sin(-t))", math.pi, 2), ("sin(cos(pi*t))", 1, 2)):
            found, times = checker.period(checker.formula(text))
            self.assertAlmostEqual(float(found[0]), unit, 15)
            self.assertAlmostEqual(float(found[1]), unit, 15)
            self.assertEqual(times, length, text)
        for text in ("sin(t) + sin(pi*t)", "sin(t^2)", "t*sin(t)", "sin(0*t)", "2", "sin(pi*pi*t)", "sin(t/pi)"):
            self.assertRaises(checker.Undecided, checker.period, checker.formula(text))

    def test_no_slope_leads_over_a_jump(self):
        """At rest until 1 s, the third derivative of this curve jumps to 7.5 and falls from there by 22.5 in a second."""
        jump = "points", (checker.Fraction(1), checker.Fraction(3)), (checker.Fraction(0), checker.Fraction(1)), 3
        before = checker.Fraction(17, 20), checker.Fraction(23, 20) - checker.Fraction(1, 1000)
        self.assertEqual(checker.enclose(jump, before)[1], checker.Fraction(15, 2))
        for piece in (before, (checker.Fraction(17, 20), checker.Fraction(12, 10)), (checker.Fraction(2), checker.Fraction(5, 2))):
            self.assertRaises(checker.Undecided, checker.straight, jump, piece)
        self.assertEqual(checker.straight((*jump[:3], 2), (checker.Fraction(0), checker.Fraction(1, 2))), (0, 0))

    def test_intervals_hold_all_that_is_sampled(self):
        draw = random.Random(4)
        for text in ("sin(t)*cos(2*t) + t^3/9", "tanh(t - 1)/(2 + cos(t))", "exp(-t^2) + atan(3*t)", "sqrt(1 + t^2) - abs(t)", "max(t, 1)^1.5"):
            tree = checker.formula(text)
            for _ in often(60):
                low = draw.uniform(-4, 4)
                high = low + draw.uniform(0, 1.5)
                found = checker.enclose(tree, (checker.Fraction(low), checker.Fraction(high)))
                values = [value_at(text, low + (high - low) * k / 100) for k in range(101)]
                self.assertLessEqual(float(found[0]), min(values) + 1e-9, text)
                self.assertGreaterEqual(float(found[1]), max(values) - 1e-9, text)


if __name__ == "__main__":
    unittest.main()
