"""The circuits of this folder as automata, their equations written by hand from the decks beside. Parameters bear the names of the decks' elements."""
from mpmath import mp, mpf

from automaton import Circuit, Mode

i, v = "i(L1)", "v(C1)"


def filter_of(p, input_voltage, drop=None):
    """L1 from a node at `input_voltage` (a row) to C1 parallel to R1; the switch's resistance `drop`."""
    current = {name: value / p["L1"] for name, value in input_voltage.items()}
    current[i] = current.get(i, 0) - (drop or 0) / p["L1"]
    current[v] = current.get(v, 0) - 1 / p["L1"]
    return {i: current, v: {i: 1 / p["C1"], v: -1 / (p["R1"] * p["C1"])}}


def idle(p):
    return Mode({v: {v: -1 / (p["R1"] * p["C1"])}}, output={v: 1})


def buck(p):
    out = {v: 1}
    return Circuit([i, v], {"one": 1, "Vin": p["Vin"]},
                   {"on": Mode(filter_of(p, {"Vin": 1}, p["Ron"]), output=out),
                    "off": Mode(filter_of(p, {"one": -p["Vf"]}, p["Rd"]), [({i: 1}, "idle", {i: {}})], out),
                    "idle": idle(p)},
                   "on", p["T"], [(p["Ton"], {"on": "off"}, None), (p["T"], {"off": "on", "idle": "on"}, None)])


def boost(p):
    out, load = {v: 1}, -1 / (p["R1"] * p["C1"])
    return Circuit([i, v], {"one": 1, "Vin": p["Vin"]},
                   {"on": Mode({i: {"Vin": 1 / p["L1"], i: -p["Ron"] / p["L1"]}, v: {v: load}}, output=out),
                    "off": Mode({i: {"Vin": 1 / p["L1"], "one": -p["Vf"] / p["L1"], i: -p["Rd"] / p["L1"], v: -1 / p["L1"]},
                                 v: {i: 1 / p["C1"], v: load}}, [({i: 1}, "idle", {i: {}})], out),
                    "idle": idle(p)},
                   "on", p["T"], [(p["Ton"], {"on": "off"}, None), (p["T"], {"off": "on", "idle": "on"}, None)])


def buck_boost(p):
    """v(C1) is negative: L1 to ground, the diode from the output to it."""
    out, load = {v: 1}, -1 / (p["R1"] * p["C1"])
    return Circuit([i, v], {"one": 1, "Vin": p["Vin"]},
                   {"on": Mode({i: {"Vin": 1 / p["L1"], i: -p["Ron"] / p["L1"]}, v: {v: load}}, output=out),
                    "off": Mode({i: {"one": -p["Vf"] / p["L1"], i: -p["Rd"] / p["L1"], v: 1 / p["L1"]}, v: {i: -1 / p["C1"], v: load}},
                                [({i: 1}, "idle", {i: {}})], out),
                    "idle": idle(p)},
                   "on", p["T"], [(p["Ton"], {"on": "off"}, None), (p["T"], {"off": "on", "idle": "on"}, None)])


def cuk(p):
    i2, vc = "i(L2)", "v(C2)"
    def rows(on):
        # C1 lies between the switch node and the diode node; i(L2) flows from the diode node to the output. The sum i(L1) - i(L2) flows in the switch or in
        # the diode: the switch node lies at Ron (i1 - i2), or the diode node at Vf + Rd (i1 - i2).
        if on:
            l1 = {"Vin": 1, i: -p["Ron"], i2: p["Ron"]}
            l2 = {i: p["Ron"], i2: -p["Ron"], v: -1, vc: -1}
        else:
            l1 = {"Vin": 1, v: -1, "one": -p["Vf"], i: -p["Rd"], i2: p["Rd"]}
            l2 = {"one": p["Vf"], i: p["Rd"], i2: -p["Rd"], vc: -1}
        c1 = {i2: 1} if on else {i: 1}
        return {i: {k: x / p["L1"] for k, x in l1.items()}, i2: {k: x / p["L2"] for k, x in l2.items()},
                v: {k: x / p["C1"] for k, x in c1.items()}, vc: {i2: 1 / p["C2"], vc: -1 / (p["R1"] * p["C2"])}}
    out = {vc: 1}
    return Circuit([i, i2, v, vc], {"one": 1, "Vin": p["Vin"]}, {"on": Mode(rows(True), output=out), "off": Mode(rows(False), output=out)},
                   "on", p["T"], [(p["Ton"], {"on": "off"}, None), (p["T"], {"off": "on"}, None)])


def input_filter(p):
    """A buck behind an input filter L2, C2 damped by R2 in series with L2."""
    i2, vc = "i(L2)", "v(C2)"
    def mode(on):
        rows = filter_of(p, {vc: 1} if on else {"one": -p["Vf"]}, p["Ron"] if on else p["Rd"])
        rows[i2] = {"Vin": 1 / p["L2"], i2: -p["R2"] / p["L2"], vc: -1 / p["L2"]}
        rows[vc] = {i2: 1 / p["C2"], i: -1 / p["C2"] if on else 0}
        return Mode(rows, output={v: 1})
    return Circuit([i, v, i2, vc], {"one": 1, "Vin": p["Vin"]}, {"on": mode(True), "off": mode(False)},
                   "on", p["T"], [(p["Ton"], {"on": "off"}, None), (p["T"], {"off": "on"}, None)])


def modulator(p):
    return Circuit([i, v], {"one": 1, "Vin": p["Vin"], "Vc": p["Vc"], "ramp": 0},
                   {"on": Mode({**filter_of(p, {"Vin": 1}), "ramp": {"one": 1 / p["T"]}}, [({"Vc": 1, "ramp": -1}, "off", None)], {v: 1}),
                    "off": Mode({**filter_of(p, {}), "ramp": {"one": 1 / p["T"]}}, output={v: 1})},
                   "on", p["T"], [(p["T"], {"off": "on"}, {"ramp": {}})])


def peak_current(p):
    return Circuit([i, v], {"one": 1, "Vin": p["Vin"], "Vctl": p["Vctl"], "ramp": 0},
                   {"on": Mode({**filter_of(p, {"Vin": 1}), "ramp": {"one": p["slope"]}}, [({"Vctl": 1, i: -1, "ramp": -1}, "off", None)], {v: 1}),
                    "off": Mode({**filter_of(p, {}), "ramp": {"one": p["slope"]}}, output={v: 1})},
                   "on", p["T"], [(p["T"], {"off": "on"}, {"ramp": {}})], {i: p["guess_i"], v: p["guess_v"]})


def deane_hamill(p):
    ramp = {"one": mpf("4.4") / p["T"]}
    difference = {"ramp": 1, v: -mpf("8.4"), "one": mpf("8.4") * mpf("11.3")}  # ramp - control
    opposite = {k: -x for k, x in difference.items()}
    reset = {"ramp": {"one": mpf("3.8")}}
    n = int(p["k"])
    return Circuit([i, v], {"one": 1, "Vin": p["Vin"], "ramp": mpf("3.8")},
                   {"on": Mode({**filter_of(p, {"Vin": 1}), "ramp": ramp}, [(difference, "off", None)], {v: 1}),
                    "off": Mode({**filter_of(p, {}), "ramp": ramp}, [(opposite, "on", None)], {v: 1})},
                   "off", n * p["T"], [((k + 1) * p["T"], {"on": "off"}, reset) for k in range(n)], {i: p["guess_i"], v: p["guess_v"]})


def timer(p):
    tau, fall = (p["R1"] + p["R2"]) * p["C1"], p["R2"] * p["C1"]
    return Circuit([v], {"one": 1, "Vcc": p["Vcc"]},
                   {"low": Mode({v: {v: -1 / fall}}, [({v: 1, "one": -3}, "high", None)], {v: 1}),
                    "high": Mode({v: {v: -1 / tau, "Vcc": 1 / tau}}, [({v: -1, "one": 6}, "low", None)], {v: 1})},
                   "low", None, ahead={v: 6}, span=mpf("1.5e-3"))


def relay(p):
    def mode(level, guard, to):
        return Mode({i: {"one": level / p["L1"], i: -p["R1"] / p["L1"], v: -1 / p["L1"]}, v: {i: 1 / p["C1"]}}, [(guard, to, None)], {v: 1})
    return Circuit([i, v], {"one": 1},
                   {"closed": mode(-1, {v: 1, "one": mpf("0.1")}, "open"), "open": mode(1, {v: -1, "one": mpf("0.1")}, "closed")},
                   "closed", None, ahead={v: mpf("0.1"), i: mpf("0.05")}, span=mpf("7e-4"))


def hysteretic(p):
    den = 1 / p["R1"] + 1 / p["Resr"]
    out = {i: 1 / den, v: 1 / p["Resr"] / den}
    def mode(drive, guard, to):
        voltage = {k: -x for k, x in out.items()}
        for k, x in drive.items():
            voltage[k] = voltage.get(k, 0) + x
        return Mode({i: {k: x / p["L1"] for k, x in voltage.items()},
                     v: {i: (1 - out[i] / p["R1"]) / p["C1"], v: -out[v] / p["R1"] / p["C1"]}}, [(guard, to, None)], out)
    above = {**{k: -x for k, x in out.items()}, "one": mpf("5.05")}
    below = {**out, "one": -mpf("4.95")}
    return Circuit([i, v], {"one": 1, "Vin": p["Vin"]},
                   {"on": mode({"Vin": 1, i: -p["Ron"]}, above, "off"), "off": mode({"one": -p["Vf"], i: -p["Rd"]}, below, "on")},
                   "on", None, ahead={i: 2, v: mpf("4.95")}, span=mpf("2e-5"))


def sine(p, amplitude):
    w = 2 * mp.pi * p["f"]
    return w, {"one": 1, "s": 0, "c": mpf(amplitude), "u": 0}, {"s": {"c": w}, "c": {"s": -w}}  # u: a small input in series with the source


def half_wave(p):
    w, sources, turning = sine(p, p["V1"])
    return Circuit([v], sources,
                   {"on": Mode({v: {"c": w, "u'": 1}, **turning},
                               [({"c": w * p["C1"], "u'": p["C1"], "s": 1 / p["R1"], "u": 1 / p["R1"]}, "off", None)], {v: 1}),
                    "off": Mode({v: {v: -1 / (p["R1"] * p["C1"])}, **turning}, [({v: 1, "s": -1, "u": -1}, "on", None)], {v: 1})},
                   "off", 1 / p["f"], ahead={v: 8})


def rl_rectifier(p):
    """A diode in series with R1 and L1: the current ends before the next half-wave."""
    w, sources, turning = sine(p, p["V1"])
    return Circuit([i], sources,
                   {"on": Mode({i: {"s": 1 / p["L1"], "u": 1 / p["L1"], i: -p["R1"] / p["L1"]}, **turning}, [({i: 1}, "idle", {i: {}})], {i: 1}),
                    "idle": Mode(turning)}, "on", 1 / p["f"], [(1 / p["f"], {"idle": "on"}, {"s": {}, "c": {"one": p["V1"]}})])


def freewheel(p):
    w, sources, turning = sine(p, p["V1"])
    return Circuit([i], sources,
                   {"on": Mode({i: {"s": 1 / p["L1"], "u": 1 / p["L1"], i: -p["R1"] / p["L1"]}, **turning}, [({"s": 1, "u": 1}, "off", None)], {i: 1}),
                    "off": Mode({i: {i: -p["R1"] / p["L1"]}, **turning}, output={i: 1})},
                   "on", 1 / p["f"], [(1 / p["f"], {"off": "on"}, {"s": {}, "c": {"one": p["V1"]}})])


def resonant_rectifier(p):
    w, sources, turning = sine(p, p["V1"])
    v2 = "v(C2)"
    voltage = {v: 1, i: p["R1"], v2: -1}  # across the diode without its current
    series = p["R1"] + p["R2"]
    def mode(on):
        diode = {k: x / series for k, x in voltage.items()} if on else {}
        l1 = {"s": 1, "u": 1, v: -1, i: -p["R1"]}
        for k, x in diode.items():
            l1[k] = l1.get(k, 0) + p["R1"] * x
        c1 = {i: 1, **{k: -x for k, x in diode.items() if k != i}}
        c1[i] = 1 - diode.get(i, 0)
        c2 = dict(diode)
        c2[v2] = c2.get(v2, 0) - 1 / p["R3"]
        return {i: {k: x / p["L1"] for k, x in l1.items()}, v: {k: x / p["C1"] for k, x in c1.items()},
                v2: {k: x / p["C2"] for k, x in c2.items()}, **turning}
    return Circuit([i, v, v2], sources,
                   {"on": Mode(mode(True), [(voltage, "off", None)], {v2: 1}),
                    "off": Mode(mode(False), [({k: -x for k, x in voltage.items()}, "on", None)], {v2: 1})},
                   "off", 1 / p["f"], ahead={i: 0, v: -2000, v2: 600})


def inverter(p):
    """Each switch with a diode of the same resistance across it, which shares the current that flows backwards: half the resistance."""
    w, sources, turning = sine(p, mpf("0.8"))
    sources = {**sources, "tri": -1, "slope": 1}
    half = p["T"] / 2
    turning = {**turning, "tri": {"slope": 2 / half}}
    def mode(high, positive):
        r = p["Ron"] if high == positive else p["Ron"] / 2
        rows = {i: {"one": ((p["Vdc"] if high else 0) - p["Vm"]) / p["L1"], i: -(p["R1"] + r) / p["L1"]}, **turning}
        names = ("h" if high else "l"), ("p" if positive else "n")
        sign = 1 if positive else -1
        level = 1 if high else -1
        return Mode(rows, [({i: sign}, names[0] + ("n" if positive else "p"), None),
                           ({"s": level, "tri": -level}, ("l" if high else "h") + names[1], None)], {i: 1})
    modes = {a + b: mode(a == "h", b == "p") for a in "hl" for b in "pn"}
    same = {name: name for name in modes}
    count = int(mp.nint(1 / p["f"] / half))
    return Circuit([i], sources, modes, "hn", 1 / p["f"], [(k * half, same, {"slope": {"slope": -1}}) for k in range(1, count)],
                   {i: -5})


def charge_pump(p):
    f, o = "v(Cf)", "v(Co)"
    total = p["Cf"] + p["Co"]
    both = {o: -1 / (p["R1"] * total), "Vin'": p["Cf"] / total}
    # at t = T/2: v(Cf) + Vin = v(Co), and Co takes what Cf gives
    share = {f: p["Cf"] / total, o: p["Co"] / total, "Vin": p["Cf"] / total}
    return Circuit([f, o], {"one": 1, "Vin": p["Vin"]},
                   {"fill": Mode({f: {"Vin'": 1}, o: {o: -1 / (p["R1"] * p["Co"])}}, output={o: 1}),
                    "give": Mode({o: both, f: {**both, "Vin'": both["Vin'"] - 1}}, output={o: 1})},
                   "fill", p["T"], [(p["T"] / 2, {"fill": "give"}, {o: share, f: {**share, "Vin": share["Vin"] - 1}}),
                                    (p["T"], {"give": "fill"}, {f: {"Vin": 1}})])


def series_resonant(p):
    """R, L, C under a square wave of +-1: x0 = (I + e^{Ah})^{-1}(I - e^{Ah}) (0, -1)."""
    def mode(level):
        return Mode({i: {"one": level * p["V1"] / p["L1"], "u": 1 / p["L1"], i: -p["R1"] / p["L1"], v: -1 / p["L1"]}, v: {i: 1 / p["C1"]}}, output={i: 1})
    return Circuit([i, v], {"one": 1, "u": 0}, {"high": mode(1), "low": mode(-1)}, "high", p["T"],
                   [(p["T"] / 2, {"high": "low"}, None), (p["T"], {"low": "high"}, None)])


def rc_square(p):
    rate = 1 / (p["R1"] * p["C1"])
    return Circuit([v], {"one": 1, "V1": p["V1"], "u": 0},
                   {"high": Mode({v: {"V1": rate, "u": rate, v: -rate}}, output={v: 1}), "low": Mode({v: {"u": rate, v: -rate}}, output={v: 1})},
                   "high", p["T"], [(p["T"] / 2, {"high": "low"}, None), (p["T"], {"low": "high"}, None)])


def flux(p):
    """A coil across a source: the offset of its current is free; the RC circuit beside it is not."""
    w, sources, turning = sine(p, p["V1"])
    return Circuit([i, v], sources, {"only": Mode({i: {"s": 1 / p["L1"]}, v: {"s": 1 / (p["R1"] * p["C1"]), v: -1 / (p["R1"] * p["C1"])}, **turning},
                                                  output={v: 1})}, "only", 1 / p["f"])


SWITCHER = {"T": "10u", "Ron": "10m", "Rd": "10m"}
DH = {"L1": "20m", "C1": "47u", "R1": "22", "T": "400u", "k": "1", "guess_i": "0.5", "guess_v": "12"}
PEAK = {"Vin": "12", "L1": "20u", "C1": "100u", "R1": "3", "Vctl": "3.5", "T": "10u", "guess_v": "7", "guess_i": "2"}

# deck -> (equations, parameters, options of Orbit, signal of the mean, input of .ac or (its name here, its card), frequencies in units of 1/T,
# parameters of .sens)
CIRCUITS = {
    "rc_square": (rc_square, {"V1": "1", "R1": "1k", "C1": "1u", "T": "1m"}, {}, "v(b)", ("u", "V1"), ["0.1", "1.3"], ["R1", "C1"]),
    "half_wave": (half_wave, {"V1": "10", "f": "50", "C1": "100u", "R1": "1k"}, {}, "v(out)", ("u", "V1"), ["0.1", "1.3"], ["R1", "C1"]),
    "rl_rectifier": (rl_rectifier, {"V1": "10", "f": "50", "L1": "20m", "R1": "10"}, {}, "i(L1)", ("u", "V1"), ["0.1", "1.3"], ["R1", "L1"]),
    "freewheel": (freewheel, {"V1": "10", "f": "50", "L1": "50m", "R1": "5"}, {}, "i(L1)", ("u", "V1"), ["0.1", "1.3"], ["R1", "L1"]),
    "buck": (buck, {**SWITCHER, "Vin": "12", "L1": "10u", "C1": "100u", "R1": "1", "Ton": "4u", "Vf": "0.3"}, {}, "v(out)", "Vin",
             ["0.01", "0.3", "1.7"], ["R1", "L1", "C1", "Vin"]),
    "buck_discontinuous": (buck, {**SWITCHER, "Vin": "12", "L1": "10u", "C1": "20u", "R1": "40", "Ton": "3u", "Vf": "0.3"}, {}, "v(out)", "Vin",
                           ["0.01", "0.3", "1.7"], ["R1", "L1", "C1", "Vin"]),
    "buck_guess_continuous": (buck, {**SWITCHER, "Vin": "12", "L1": "10u", "C1": "100u", "R1": "1k", "Ton": "3u", "Vf": "0.3"}, {"settle": 3000},
                              "v(out)", None, [], ["R1", "L1"]),
    "boost": (boost, {**SWITCHER, "Vin": "5", "L1": "20u", "C1": "50u", "R1": "10", "Ton": "5u", "Vf": "0.4"}, {}, "v(out)", "Vin",
              ["0.02", "0.4", "1.3"], ["R1", "L1", "C1", "Vin"]),
    "boost_discontinuous": (boost, {**SWITCHER, "Rd": "0", "Vf": "0", "Vin": "5", "L1": "5u", "C1": "20u", "R1": "100", "Ton": "2u"}, {}, "v(out)", "Vin",
                            ["0.01", "0.4", "1.3"], ["R1", "L1", "C1", "Vin"]),
    "buck_boost": (buck_boost, {**SWITCHER, "Vin": "12", "L1": "20u", "C1": "50u", "R1": "5", "Ton": "4u", "Vf": "0.4"}, {}, "v(out)", "Vin",
                   ["0.02", "0.4", "1.3"], ["R1", "L1", "C1", "Vin"]),
    "cuk": (cuk, {**SWITCHER, "Vin": "12", "L1": "50u", "L2": "50u", "C1": "10u", "C2": "47u", "R1": "5", "Ton": "4u", "Vf": "0.4"}, {"settle": 1500},
            "v(out)", "Vin", ["0.02", "0.4"], ["R1", "L1", "L2", "C1"]),
    "input_filter": (input_filter, {**SWITCHER, "Vin": "12", "L1": "10u", "C1": "100u", "R1": "1", "L2": "4.7u", "R2": "0.1", "C2": "22u", "Ton": "4u",
                                    "Vf": "0.3"}, {}, "v(out)", "Vin", ["0.03", "0.4"], ["R1", "L2", "C2", "R2"]),
    "modulator": (modulator, {"Vin": "12", "Vc": "0.4", "L1": "10u", "C1": "100u", "R1": "1", "T": "10u"}, {}, "v(out)", "Vc",
                  ["0.01", "0.3", "1.7"], ["R1", "L1", "Vc"]),
    "peak_current_buck": (peak_current, {**PEAK, "slope": "0"}, {"settle": 0}, "v(out)", "Vctl", ["0.01", "0.3"], ["R1", "L1", "Vctl", "Vin"]),
    "peak_current_slope": (peak_current, {**PEAK, "slope": "100k"}, {"settle": 0}, "v(out)", "Vctl", ["0.01", "0.3"], ["R1", "L1", "Vctl", "Vin"]),
    "peak_current_below": (peak_current, {**PEAK, "R1": "1.2", "guess_v": "4", "guess_i": "3", "slope": "0"}, {"settle": 20}, "v(out)", "Vctl",
                           ["0.01", "0.3"], ["R1", "L1", "Vctl", "Vin"]),
    "deane_hamill": (deane_hamill, {**DH, "Vin": "20"}, {"settle": 60}, "v(out)", "Vin", ["0.05", "0.7"], ["R1", "L1", "C1", "Vin"]),
    "deane_hamill_unstable": (deane_hamill, {**DH, "Vin": "25"}, {"settle": 0}, "v(out)", "Vin", ["0.05", "0.7"], ["R1", "L1", "C1", "Vin"]),
    "deane_hamill_doubled": (deane_hamill, {**DH, "Vin": "25", "k": "2"}, {"settle": 200}, "v(out)", "Vin", ["0.1"], ["R1", "L1", "C1", "Vin"]),
    "timer": (timer, {"Vcc": "9", "R1": "1k", "R2": "10k", "C1": "100n"}, {"settle": 3}, "v(c)", "Vcc", ["0.1", "1.7"], ["R1", "R2", "C1", "Vcc"]),
    "relay": (relay, {"L1": "1m", "R1": "10", "C1": "10u"}, {"settle": 60}, "v(c)", None, [], ["R1", "L1", "C1"]),
    "hysteretic": (hysteretic, {"Vin": "12", "Ron": "10m", "Rd": "10m", "Vf": "0.4", "L1": "20u", "Resr": "0.1", "C1": "100u", "R1": "2"},
                   {"settle": 100}, "v(out)", "Vin", ["0.1", "1.7"], ["R1", "L1", "Resr", "Vin"]),
    "resonant_rectifier": (resonant_rectifier, {"V1": "1", "f": "5032.921210448703", "L1": "1m", "C1": "1u", "R1": "3.16m", "R2": "1e6", "C2": "1n",
                                                "R3": "1e6"}, {"settle": 0}, "v(p)", ("u", "V1"), ["0.1", "1.3"], ["R1", "R2", "R3"]),
    "inverter": (inverter, {"Vdc": "400", "Vm": "200", "f": "50", "T": "100u", "Ron": "10m", "L1": "2m", "R1": "10"},
                 {"settle": 1}, "i(L1)", None, [], ["R1", "L1"]),
    "charge_pump": (charge_pump, {"Vin": "5", "Cf": "1u", "Co": "10u", "R1": "1k", "T": "10u"}, {}, "v(out)", "Vin", ["0.01", "0.3"],
                    ["R1", "Cf", "Co", "Vin"]),
    "series_resonant": (series_resonant, {"V1": "1", "L1": "100u", "C1": "1u", "R1": "2", "T": "70u"}, {}, "i(L1)", ("u", "V1"), ["0.1", "1.3"], ["R1", "C1"]),
    "flux": (flux, {"V1": "1", "f": "50", "L1": "10m", "R1": "1k", "C1": "1u"}, {"settle": 0, "kept": ["i(L1)"]}, "v(b)", None, [], []),
}
