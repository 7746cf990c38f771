#!/usr/bin/env python3
"""Writes the stuck-at fault dictionaries of three ISCAS-85 circuits beside it: c17, c432 and c499.

The circuits are those of F. Brglez and H. Fujiwara, "A neutral netlist of 10 combinational benchmark
circuits and a target translator in Fortran", Int. Symp. on Circuits and Systems, 1985. They are written
out here by their regular parts. What D. Bryan, "The ISCAS '85 benchmark circuits and netlist format",
MCNC, 1988, and the heads of the distributed netlists print of them has to come out: inputs, outputs,
gates, lines, fanout stems and branches, and the number of faults that are left when equivalent ones are
collapsed. Two more checks are of what the circuits do: c432 grants requests of three buses by priority,
c499 corrects one wrong bit of 32.

A state is what a set of vectors tells apart from all others: the good circuit, or faults with equal
rows. A test is one vector; it fails where any output differs from the good circuit's.
"""

from itertools import groupby
from math import log2
from pathlib import Path
from random import Random

HERE = Path(__file__).parent
SEED = 1985
# Vectors from which those are taken that tell faults apart, and how many are compared for each place.
POOL = 20_000
COMPARED = 512

# What is printed of each circuit.
PRINTED = {
    "c17": {"inputs": 5, "outputs": 2, "gates": 6, "lines": 17, "stems": 3, "branches": 6, "faults": 22},
    "c432": {"inputs": 36, "outputs": 7, "gates": 160, "lines": 432, "stems": 89, "branches": 236, "faults": 524},
    "c499": {"inputs": 41, "outputs": 32, "gates": 202, "lines": 499, "stems": 59, "branches": 256, "faults": 758},
}


class Circuit:
    """Gates in an order in which each follows what drives it."""

    def __init__(self, inputs):
        self.inputs = list(inputs)
        self.gates = {}
        self.outputs = []

    def add(self, name, kind, *pins):
        """A gate; gives its name back."""
        assert name not in self.gates and all(pin in self.gates or pin in self.inputs for pin in pins)
        self.gates[name] = (kind, pins)
        return name

    def readers(self):
        """For each net the gate pins that it drives."""
        readers = {net: [] for net in [*self.inputs, *self.gates]}
        for gate, (_, pins) in self.gates.items():
            for place, pin in enumerate(pins):
                readers[pin].append((gate, place))
        return readers

    def faults(self):
        """Faults (net, pin, value) without those that one gate makes equivalent to others.

        A line is the net itself (pin None) or its branch to one pin of a gate where it has several. An
        AND gate with an input stuck at 0 is one with its output stuck at 0; NAND, OR, NOR and NOT alike.
        """
        branch = {net for net, pins in self.readers().items() if len(pins) > 1}
        kept = []
        for net, readers in self.readers().items():
            lines = [None, *readers] if net in branch else [None]
            for pin in lines:
                reader = pin or (readers[0] if readers and net not in branch else None)
                kind = self.gates[reader[0]][0] if reader else None
                controlling = {"and": [0], "nand": [0], "or": [1], "nor": [1], "not": [0, 1]}
                gone = controlling.get(kind, []) if reader else []
                kept += [(net, pin, value) for value in (0, 1) if value not in gone]
        return kept

    def run(self, values, ones, fault=None):
        """Values of all nets, one bit for each vector; `ones` has all bits set."""
        net, pin, value = fault or (None, None, 0)
        stuck = ones * value
        values = dict(values)
        if fault and pin is None and net in values:
            values[net] = stuck
        for gate, (kind, pins) in self.gates.items():
            read = [stuck if (gate, place) == pin else values[at] for place, at in enumerate(pins)]
            out = read[0]
            for other in read[1:]:
                out = out & other if kind in ("and", "nand") else out ^ other if kind == "xor" else out | other
            values[gate] = out ^ ones if kind in ("nand", "nor", "not") else out
            if fault and pin is None and gate == net:
                values[gate] = stuck
        return values

    def counts(self):
        driven = [len(pins) for pins in self.readers().values()]
        branches = sum(count for count in driven if count > 1)
        return {
            "inputs": len(self.inputs), "outputs": len(self.outputs), "gates": len(self.gates),
            "lines": len(driven) + branches, "stems": sum(count > 1 for count in driven),
            "branches": branches, "faults": len(self.faults()),
        }


def c17():
    circuit = Circuit(["1", "2", "3", "6", "7"])
    for name, *pins in [("10", "1", "3"), ("11", "3", "6"), ("16", "2", "11"), ("19", "11", "7"),
                        ("22", "10", "16"), ("23", "16", "19")]:
        circuit.add(name, "nand", *pins)
    circuit.outputs = ["22", "23"]
    return circuit


def c432():
    """Nine channels, each with an enable `e` and active-low requests on the buses `a`, `b` and `c`."""
    channels = range(9)
    circuit = Circuit(f"{bus}{i}" for i in channels for bus in "aebc")
    add = circuit.add
    for i in channels:
        add(f"na{i}", "not", f"a{i}")
        add(f"ne{i}", "not", f"e{i}")
        add(f"ra{i}", "nand", f"na{i}", f"e{i}")
        add(f"rb{i}", "nor", f"b{i}", f"ne{i}")
        add(f"rc{i}", "nor", f"c{i}", f"ne{i}")
    add("none_a", "and", *(f"ra{i}" for i in channels))
    pa, ga, oa = (add(name, "not", "none_a") for name in ("pa", "ga", "out_a"))
    for i in channels:
        add(f"xa{i}", "xor", pa, f"ra{i}")
        add(f"fa{i}", "nand", f"a{i}", ga)
        add(f"sb{i}", "nand", f"xa{i}", f"rb{i}")
        add(f"sc{i}", "nand", f"xa{i}", f"rc{i}")
        add(f"nc{i}", "not", f"sc{i}")
    add("none_b", "and", *(f"sb{i}" for i in channels))
    pb, gb, ob = (add(name, "not", "none_b") for name in ("pb", "gb", "out_b"))
    for i in channels:
        add(f"xb{i}", "xor", pb, f"sb{i}")
        add(f"fb{i}", "nand", f"b{i}", gb)
        add(f"tc{i}", "nand", f"xb{i}", f"nc{i}")
    add("none_c", "and", *(f"tc{i}" for i in channels))
    gc, oc = (add(name, "not", "none_c") for name in ("gc", "out_c"))
    for i in channels:
        add(f"fc{i}", "nand", f"c{i}", gc)
        # Low where the channel is acknowledged.
        add(f"k{i}", "nand", f"e{i}", f"fa{i}", f"fb{i}", f"fc{i}")
    k0, k1, k2, k3, k4, k5, k6, k7, _ = (f"k{i}" for i in channels)
    y0, y3, y5, y6, y7 = (add(f"y{i}", "not", f"k{i}") for i in (0, 3, 5, 6, 7))
    others = add("others", "and", *(f"k{i}" for i in channels if i))
    third = add("third", "nand", k2, y3)
    fifth = add("fifth", "nand", k2, k3, y5, k4)
    sixth = add("sixth", "nand", k4, k3, y6)
    seventh = add("seventh", "nand", k2, k3, k6, y7)
    circuit.outputs = [
        oa, ob, oc, add("out_3", "nor", y0, others), add("out_2", "nand", k1, k2, third, k4),
        add("out_1", "nand", k1, k2, fifth, sixth), add("out_0", "nand", k1, third, fifth, seventh),
    ]
    return circuit


def c499():
    """32 data bits `d`, 8 check bits `c`, and `r` that lets the check bits through."""
    circuit = Circuit([*(f"d{i}" for i in range(32)), *(f"c{i}" for i in range(8)), "r"])
    add = circuit.add
    pairs = [add(f"xa{i}", "xor", f"d{2 * i}", f"d{2 * i + 1}") for i in range(16)]
    checks = [add(f"h{i}", "and", f"c{i}", "r") for i in range(8)]
    columns = []
    for i in range(8):
        first = 16 * (i // 4) + i % 4
        low = add(f"xb{i}", "xor", f"d{first}", f"d{first + 4}")
        high = add(f"xc{i}", "xor", f"d{first + 8}", f"d{first + 12}")
        columns.append(add(f"xe{i}", "xor", low, high))
    fours = [add(f"f{i}", "xor", pairs[2 * i], pairs[2 * i + 1]) for i in range(8)]
    joined = [(0, 1), (2, 3), (0, 2), (1, 3)]
    rows = [add(f"g{4 * half + i}", "xor", fours[4 * half + one], fours[4 * half + other])
            for half in (0, 1) for i, (one, other) in enumerate(joined)]
    syndrome = []
    for i in range(8):
        check = add(f"xd{i}", "xor", checks[i], rows[(i + 4) % 8])
        syndrome.append(add(f"s{i}", "xor", columns[i], check))

    def match(name, half, pattern, *more):
        """An AND gate with inverters of its own before the syndrome bits that have to be 0."""
        bits = [syndrome[4 * half + i] if bit else add(f"{name}y{i}", "not", syndrome[4 * half + i])
                for i, bit in enumerate(pattern)]
        return add(name, "and", *bits, *more)

    one = [(0, 0, 0, 1), (0, 0, 1, 0), (0, 1, 0, 0), (1, 0, 0, 0)]
    two = [(1, 0, 1, 0), (1, 0, 0, 1), (0, 1, 1, 0), (0, 1, 0, 1)]
    single = [add(f"u{half}", "or", *(match(f"t{half}{i}", half, bits) for i, bits in enumerate(one)))
              for half in (0, 1)]
    for half in (0, 1):
        for i, bits in enumerate(two):
            word = match(f"w{half}{i}", 1 - half, bits, single[half])
            for j in range(4):
                bit = 16 * half + 4 * i + j
                wrong = add(f"e{bit}", "and", syndrome[4 * half + j], word)
                circuit.outputs.append(add(f"o{bit}", "xor", f"d{bit}", wrong))
    return circuit


def check_c432(circuit, dice):
    """Against the circuit's behaviour, written anew: bus a goes before b before c."""
    for _ in range(2_000):
        weight = dice.choice((2, 4, 8, 16))
        bits = {net: int(dice.randrange(weight) > 0) for net in circuit.inputs}
        asks = {bus: [bits[f"e{i}"] and not bits[f"{bus}{i}"] for i in range(9)] for bus in "abc"}
        heard, granted = [True] * 9, {}
        for bus in "abc":
            wanted = [ask and ear for ask, ear in zip(asks[bus], heard)]
            granted[bus] = any(wanted)
            heard = [ear and (want or not granted[bus]) for ear, want in zip(heard, wanted)]
        found = circuit.run(bits, 1)
        assert [found[f"out_{bus}"] for bus in "abc"] == [int(granted[bus]) for bus in "abc"]
        told = [bits[f"e{i}"] and all(not (granted[bus] and bits[f"{bus}{i}"]) for bus in "abc") for i in range(9)]
        assert [found[f"k{i}"] for i in range(9)] == [int(not yes) for yes in told]
        assert found["out_3"] == int(not told[0] and any(told))
        # The number of the one channel that is acknowledged, counted down from channel 1.
        if sum(told[1:]) == 1:
            number = 4 * found["out_2"] + 2 * found["out_1"] + found["out_0"]
            assert number == 8 - told.index(True, 1)


def check_c499(circuit, dice):
    """Any one wrong data bit comes out right; so do words without one."""
    outputs = [f"o{i}" for i in range(32)]
    for _ in range(20):
        data = {f"d{i}": dice.getrandbits(1) for i in range(32)}
        blank = {**data, **{f"c{i}": 0 for i in range(8)}, "r": 1}
        found = circuit.run(blank, 1)
        sent = {**blank, **{f"c{i}": found[f"s{i}"] for i in range(8)}}
        for wrong in [None, *range(32)]:
            got = {net: bit ^ (net == f"d{wrong}") for net, bit in sent.items()}
            seen = circuit.run(got, 1)
            assert [seen[net] for net in outputs] == list(data.values())


def vectors(circuit, dice):
    """All vectors of few inputs; else random ones, each with a share of ones of its own."""
    count = len(circuit.inputs)
    if count <= 5:
        return [[number >> bit & 1 for bit in range(count)] for number in range(2**count)]
    shares = [dice.choice((2, 4, 8, 14)) for _ in range(POOL)]
    return [[int(dice.randrange(16) < share) for _ in range(count)] for share in shares]


def rows(circuit, pool):
    """For each fault the vectors by which it is seen, as bits."""
    ones = (1 << len(pool)) - 1
    values = {}
    for place, net in enumerate(circuit.inputs):
        bits = "".join(str(vector[place]) for vector in reversed(pool))
        values[net] = int(bits, 2)
    good = circuit.run(values, ones)
    seen = {}
    for fault in circuit.faults():
        bad = circuit.run(values, ones, fault)
        row = 0
        for net in circuit.outputs:
            row |= good[net] ^ bad[net]
        seen[fault] = row
    return seen


def chosen(seen, count, dice):
    """Vectors that tell apart all that the pool tells apart: of some at random the one that tells most."""
    classes = [sorted({0, *seen.values()})]
    left, picked = list(range(count)), []

    def split(by):
        parts = ([[row for row in group if (row >> by & 1) == bit] for bit in (0, 1)] for group in classes)
        return [part for pair in parts for part in pair if part]

    def unknown(groups):
        return sum(len(group) * log2(len(group)) for group in groups)

    while classes := [group for group in classes if len(group) > 1]:
        best = min(dice.sample(left, COMPARED), key=lambda by: unknown(split(by)))
        if unknown(split(best)) == unknown(classes):
            # None of these: the first that tells two rows apart.
            apart = classes[0][0] ^ classes[0][1]
            best = (apart & -apart).bit_length() - 1
        classes = split(best)
        picked.append(best)
        left.remove(best)
    return sorted(picked)


def named(fault):
    net, pin, value = fault
    return f"{net}{'>' + pin[0] if pin else ''}/{value}"


def main():
    for build, check in [(c17, None), (c432, check_c432), (c499, check_c499)]:
        circuit, dice = build(), Random(SEED)
        name = build.__name__
        assert circuit.counts() == PRINTED[name], (name, circuit.counts())
        if check:
            check(circuit, dice)
        pool = vectors(circuit, dice)
        seen = rows(circuit, pool)
        picked = range(len(pool)) if len(circuit.inputs) <= 5 else chosen(seen, len(pool), dice)
        digits = -(-len(circuit.inputs) // 4)
        told = {None: 0, **seen}
        row = {fault: "".join(str(bits >> by & 1) for by in picked) for fault, bits in told.items()}
        states = groupby(sorted(row, key=lambda fault: row[fault]), key=lambda fault: row[fault])
        lines = [f"# {name}: a row for each state, a bit for each vector, 1 where an output is wrong"]
        lines += ["vectors " + " ".join(f"{int(''.join(map(str, pool[by])), 2):0{digits}x}" for by in picked)]
        for bits, faults in states:
            known = ["good" if fault is None else named(fault) for fault in faults]
            lines.append(f"{','.join(known)} {int(bits, 2):0{-(-len(bits) // 4)}x}")
        (HERE / f"{name}.hex").write_text("\n".join(lines) + "\n")
        print(name, len(seen), "faults,", len(lines) - 2, "states,", len(picked), "vectors")


main()
