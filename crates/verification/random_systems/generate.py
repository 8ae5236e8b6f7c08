"""Random systems of rigid bodies: `system(seed)` gives the same one for ever, `scene(system)` its scene in TOML."""

import math

import numpy as np

import reference

CLASSES = ["tree", "closed", "four-bar", "chain loop", "parallelogram", "bennett", "platform", "door", "slider-crank", "points", "impossible"]
SHARES = [0.34, 0.10, 0.09, 0.06, 0.06, 0.05, 0.06, 0.07, 0.06, 0.06, 0.05]
KINDS = ["fixed", "revolute", "prismatic", "cylindrical", "spherical", "universal", "planar"]
# Length in m, mass in kg, time in s of a unit, with the labels.
UNITS = [("m", 1, "kg", 1, "s", 1), ("mm", 1e-3, "Mg", 1e3, "s", 1), ("mm", 1e-3, "kg", 1, "ms", 1e-3), ("cm", 1e-2, "g", 1e-3, "s", 1),
         ("in", 0.0254, "slinch", 175.12683698, "s", 1), ("ft", 0.3048, "slug", 14.593903, "s", 1)]
TOLERANCES = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7]
EYE = np.eye(3)


def random_rotation(rng):
    q = rng.normal(size=4)
    return reference.rotation(q / np.linalg.norm(q))


def about(axis, angle):
    return reference.rotation(reference.small_turn(angle * np.eye(3)["xyz".index(axis)]))


def frame_of(z, x=None):
    """Axes with this z, and x as near as it can be to the given one."""
    z = z / np.linalg.norm(z)
    x = np.eye(3)[np.argmin(np.abs(z))] if x is None else x
    x = x - z * (z @ x)
    x = x / np.linalg.norm(x)
    return np.stack((x, np.cross(z, x), z), 1)


class Maker:
    """Puts bodies and joints together, in SI units about a place near the origin."""

    def __init__(self, rng):
        self.rng, self.bodies, self.joints = rng, [], []
        self.size = 10 ** rng.uniform(-1, 0.3)
        self.heavy = 10 ** rng.uniform(-2, 2)
        self.decades = rng.choice([0.5, 2.0, 4.0])

    def pose(self, body):
        if body < 0:
            return np.zeros(3), EYE
        return self.bodies[body]["place"], self.bodies[body]["matrix"]

    def body(self, place, matrix, half=None, point=False):
        rng = self.rng
        mass = self.heavy * 10 ** (-self.decades * rng.uniform())
        half = half or 0.3 * self.size
        if point:
            inertia = np.eye(3) * mass * half**2 * 1e-6
        else:
            # Principal moments of a box, in axes of its own.
            a, b, c = (half * rng.uniform(0.1, 1, 3)) ** 2
            turn = random_rotation(rng)
            inertia = turn @ np.diag([b + c, a + c, a + b]) @ turn.T * mass / 3
            inertia = (inertia + inertia.T) / 2
        self.bodies.append({"name": f"b{len(self.bodies)}", "mass": mass, "inertia": inertia.tolist(), "place": np.array(place, float),
                            "matrix": np.array(matrix, float), "point": point, "half": half,
                            "com": (rng.normal(size=3) * half * rng.choice([0, 1])).tolist()})
        return len(self.bodies) - 1

    def end(self, body, at, axes):
        """A marker at a global place with global axes."""
        x, r = self.pose(body)
        return {"body": body, "s": (r.T @ (np.array(at) - x)).tolist(), "axes": (r.T @ axes).tolist()}

    def joint(self, kind, i, j, at, axes, other=None, to=None, own=None):
        """A joint where the bodies stand: axes of the first end, and of the second one if they differ."""
        other = axes if other is None else other
        plain = other is axes and kind != "universal" and to is None
        joint = {"name": f"j{len(self.joints)}", "kind": kind, "i": self.end(i, at, axes), "j": self.end(j, at if to is None else to, other),
                 "style": "own" if own or not plain else self.rng.choice(["own", "axis"]), "along": "slide" if kind == "prismatic" else "turn"}
        self.joints.append(joint)
        return joint

    def hang(self, parent, kind, point=False):
        """A new body at a joint of an older one."""
        rng, size = self.rng, self.size
        x, r = self.pose(parent)
        half = 0.3 * size
        at = x + r @ (rng.uniform(-1, 1, 3) * half) if parent >= 0 else rng.uniform(-1, 1, 3) * half
        axes = random_rotation(rng)
        turn, slide = rng.uniform(-2, 2), rng.uniform(-0.3, 0.3) * size
        if rng.uniform() < 0.4:
            turn, slide = 0.0, 0.0
        other, to = axes, None
        if kind in ("revolute", "cylindrical", "planar") and turn:
            other = axes @ about("z", turn)
        if kind in ("prismatic", "cylindrical") and slide:
            to = at + axes[:, 2] * slide
        if kind == "planar" and slide:
            to = at + axes[:, 0] * slide
        if kind == "universal":
            other = axes @ about("x", rng.uniform(-0.5, 0.5)) @ about("y", rng.uniform(-0.5, 0.5))
        reach = random_rotation(rng)[:, 0] * half * rng.uniform(0.3, 1)
        if point and kind == "spherical":
            reach = np.zeros(3)
        new = self.body((at if to is None else to) + reach, random_rotation(rng), point=point)
        self.joint(kind, parent, new, at, axes, other, to)
        return new

    def link(self, a, b, point=False):
        """A body whose axes' x leads from one place to another."""
        d = np.array(b) - np.array(a)
        matrix = frame_of(np.array([0, 1.0, 0]) if abs(d[1]) < 1e-9 * np.linalg.norm(d) else np.cross(d, [0.3, -0.5, 0.81]), d)
        return self.body((np.array(a) + np.array(b)) / 2, matrix, half=np.linalg.norm(d) / 2, point=point)

    def hinge(self, i, j, at, z, own=None):
        return self.joint("revolute", i, j, at, frame_of(np.array(z, float)), own=own)


def tree(m, n=None, kinds=KINDS, ground=None):
    rng = m.rng
    n = n or rng.integers(1, 6)
    ground = rng.uniform() < 0.6 if ground is None else ground
    if ground:
        m.hang(-1, rng.choice([k for k in kinds if k != "fixed"] if n > 1 else [k for k in kinds if k not in ("fixed",)]))
    else:
        m.body(rng.uniform(-1, 1, 3) * m.size, random_rotation(rng))
    while len(m.bodies) < n:
        parent = int(rng.integers(-1 if ground and rng.uniform() < 0.2 else 0, len(m.bodies)))
        m.hang(parent, rng.choice(kinds, p=np.where(np.array(kinds) == "fixed", 0.4, 1) / (len(kinds) - 0.6)) if "fixed" in kinds else rng.choice(kinds))


def closed(m):
    """A tree whose last body is also held to another one."""
    rng = m.rng
    tree(m, int(rng.integers(3, 6)), ["revolute", "spherical", "universal", "cylindrical", "prismatic"], ground=rng.uniform() < 0.7)
    last = len(m.bodies) - 1
    other = int(rng.integers(-1, last)) if rng.uniform() < 0.5 else -1
    at = m.bodies[last]["place"] + rng.uniform(-1, 1, 3) * 0.3 * m.size
    m.joint(rng.choice(["spherical", "planar", "revolute", "cylindrical", "universal"]), other, last, at, random_rotation(rng), own=True)


def ring(m, corners, z, turn):
    """Links between corners of a polygon in a plane, whose first and last are on the ground."""
    corners = [turn @ np.array([c[0], 0, c[1]]) * m.size for c in corners]
    links = [-1] + [m.link(a, b) for a, b in zip(corners, corners[1:])] + [-1]
    for k, at in enumerate(corners):
        m.hinge(links[k], links[k + 1], at, z)
    return links


def place_of(m, turn):
    return turn @ np.array([0.0, 1.0, 0.0])


def four_bar(m):
    turn = random_rotation(m.rng)
    a, b = m.rng.uniform(0.3, 2.8, 2)
    la, lb = m.rng.uniform(0.3, 0.8, 2)
    ring(m, [(0, 0), (la * math.cos(a), la * math.sin(a)), (1 + lb * math.cos(b), lb * math.sin(b)), (1, 0)], place_of(m, turn), turn)


def chain_loop(m):
    turn = random_rotation(m.rng)
    n = int(m.rng.integers(4, 7))
    corners = [(math.cos(math.pi * k / (n - 1)) * m.rng.uniform(0.6, 1), math.sin(math.pi * k / (n - 1)) * m.rng.uniform(0.6, 1)) for k in range(n)]
    ring(m, corners, place_of(m, turn), turn)


def parallelogram(m):
    turn, rng = random_rotation(m.rng), m.rng
    angle, length = rng.uniform(0.5, 2.6), rng.uniform(0.4, 1)
    cranks = int(rng.integers(2, 5))
    tip = lambda k: turn @ np.array([k + length * math.cos(angle), 0, length * math.sin(angle)]) * m.size
    foot = lambda k: turn @ np.array([k, 0.0, 0.0]) * m.size
    coupler = m.link(tip(0), tip(cranks - 1))
    z = place_of(m, turn)
    for k in range(cranks):
        crank = m.link(foot(k), tip(k))
        m.hinge(-1, crank, foot(k), z)
        m.hinge(crank, coupler, tip(k), z)


def bennett(m):
    """Opposite links equal, twists as sin a / A = sin b / B; closed by numbers, from a place that the closed form gives."""
    rng = m.rng
    a, b = rng.uniform(0.4, 1.2), rng.uniform(1.3, 2.2)
    la = 0.6 * m.size
    lb = la * math.sin(b) / math.sin(a)
    theta = rng.uniform(0.6, 2.4)
    # tan(theta/2) tan(phi/2) = sin((b + a)/2) / sin((b - a)/2), theta and phi the turns of neighbouring joints.
    other = 2 * math.atan(math.sin((b + a) / 2) / math.sin((b - a) / 2) / math.tan(theta / 2))

    def step(turn, length, twist):
        out = np.eye(4)
        out[:3, :3] = about("z", turn) @ about("x", twist)
        out[:3, 3] = about("z", turn) @ np.array([length, 0, 0])
        return out

    best = None
    for signs in ((1, 1), (1, -1), (-1, 1), (-1, -1)):
        for shift in (0, math.pi):
            t, p = theta, signs[0] * other + shift
            turns = [t, p, signs[1] * t, signs[1] * p]
            lots = [step(turns[0], la, a), step(turns[1], lb, b), step(turns[2], la, a), step(turns[3], lb, b)]
            whole = lots[0] @ lots[1] @ lots[2] @ lots[3]
            off = np.linalg.norm(whole - np.eye(4))
            if best is None or off < best[0]:
                best = (off, lots)
    if best[0] > 1e-9:
        raise ValueError("this Bennett linkage does not close")
    base = np.eye(4)
    base[:3, :3] = random_rotation(rng)
    frames = [base]
    for lot in best[1]:
        frames.append(frames[-1] @ lot)
    places = [f[:3, 3] for f in frames]
    links = [-1] + [m.link(places[k], places[k + 1]) for k in range(3)] + [-1]
    for k in range(4):
        m.hinge(links[k], links[k + 1], places[k], frames[k][:3, 2])


def platform(m):
    """A plate on three or four legs; of equal and parallel ones some rows are implied."""
    rng, turn = m.rng, random_rotation(m.rng)
    legs = int(rng.integers(3, 5))
    kind = rng.choice(["parallel", "spread", "sprung"])
    height, top = rng.uniform(0.5, 1), 0.6 if kind == "parallel" else rng.uniform(0.3, 0.5)
    up = lambda x, y, z: turn @ np.array([x, y, z]) * m.size
    plate = m.body(up(0, 0, height), turn, half=0.5 * m.size)
    for k in range(legs):
        at = 2 * math.pi * (k + (0.3 if legs == 3 and kind != "parallel" and k == 0 else 0)) / legs
        foot, head = up(0.6 * math.cos(at), 0.6 * math.sin(at), 0), up(top * math.cos(at), top * math.sin(at), height)
        along = head - foot
        axes = frame_of(along)
        # The axes of the universal joint lie across the leg.
        across = np.stack((axes[:, 0], axes[:, 1], axes[:, 2]), 1)
        if kind == "sprung":
            lower = m.link(foot, foot + 0.4 * along)
            upper = m.link(foot + 0.6 * along, head)
            m.joint("universal", -1, lower, foot, across)
            slide = m.joint("prismatic", lower, upper, foot + 0.5 * along, axes)
            slide["spring"] = {"stiffness": spring_constant(m, [lower, upper, plate], 3), "damping": 0.0, "free": 0.0}
            m.joint("spherical", upper, plate, head, axes)
        else:
            leg = m.link(foot, head)
            m.joint("universal", -1, leg, foot, across)
            m.joint("spherical", leg, plate, head, axes)


def door(m):
    """Bodies held more than once: hinges on one line, twice fixed, twice prismatic, planes beside planes."""
    rng = m.rng
    tree(m, int(rng.integers(1, 4)), ["revolute", "spherical", "cylindrical"], ground=True)
    for joint in list(m.joints):
        body = joint["j"]["body"]
        if rng.uniform() < 0.7:
            x, r = m.pose(joint["i"]["body"])
            xj, rj = m.pose(body)
            axes, other = r @ np.array(joint["i"]["axes"]), rj @ np.array(joint["j"]["axes"])
            at, to = x + r @ np.array(joint["i"]["s"]), xj + rj @ np.array(joint["j"]["s"])
            if joint["kind"] == "spherical":
                m.joint("spherical", joint["i"]["body"], body, at, axes, own=True)
            else:
                kind = rng.choice([joint["kind"], "cylindrical"])
                shift = axes[:, 2] * rng.uniform(0.1, 0.5) * m.size
                m.joint(kind, joint["i"]["body"], body, at + shift, axes, other, to + shift)
    if rng.uniform() < 0.5:
        new = m.hang(len(m.bodies) - 1, "fixed")
        fixed = m.joints[-1]
        xj, rj = m.pose(new)
        m.joint("fixed", fixed["i"]["body"], new, xj, random_rotation(rng), own=True)


def slider_crank(m):
    rng, turn = m.rng, random_rotation(m.rng)
    a, l1, l2 = rng.uniform(0.3, 2.8), rng.uniform(0.2, 0.5), rng.uniform(0.8, 1.2)
    flat = lambda x, z: turn @ np.array([x, 0, z]) * m.size
    pin = (l1 * math.cos(a), l1 * math.sin(a))
    end = (pin[0] + math.sqrt(l2**2 - pin[1] ** 2), 0)
    crank, rod = m.link(flat(0, 0), flat(*pin)), m.link(flat(*pin), flat(*end))
    block = m.body(flat(*end), turn)
    z = place_of(m, turn)
    m.hinge(-1, crank, flat(0, 0), z)
    m.hinge(crank, rod, flat(*pin), z)
    m.hinge(rod, block, flat(*end), z)
    m.joint(rng.choice(["prismatic", "cylindrical"]), -1, block, flat(*end), frame_of(turn @ np.array([1.0, 0, 0])))


def points(m):
    """Point-like masses at balls, on arms at hinges, and on springs."""
    rng = m.rng
    n = int(rng.integers(1, 4))
    for _ in range(n):
        parent = len(m.bodies) - 1
        if rng.uniform() < 0.5:
            at = m.pose(parent)[0]
            new = m.body(at + random_rotation(rng)[:, 0] * 0.5 * m.size, random_rotation(rng), point=True)
            kind = rng.choice(["revolute", "spherical", "universal"])
            arm = m.pose(new)[0] - at
            m.joint(kind, parent, new, at, frame_of(np.cross(arm, rng.normal(size=3))), own=True)
        else:
            m.hang(parent, "revolute")


def impossible(m):
    """Rows that contradict each other, or a loop that nothing can close: an error is right."""
    rng = m.rng
    which = rng.choice(["drive and ball", "gear and drives", "short link"])

    def drive(at):
        """One that contradicts from the start on, or one that begins at rest and so does later."""
        rate = rng.uniform(0.5, 2)
        return {"offset": at, "rate": rate} if rng.uniform() < 0.5 else {"offset": at + rate, "amplitude": rate, "frequency": 4.0, "phase": -math.pi / 2}

    if which == "drive and ball":
        body = m.hang(-1, "revolute")
        joint = m.joints[-1]
        joint["drive"] = drive(m_turn(m, joint))
        z = np.array(joint["i"]["axes"])[:, 2]
        away = np.cross(z, rng.normal(size=3)) * m.size
        m.joint("spherical", -1, body, np.array(joint["i"]["s"]) + away, EYE, own=True)
    elif which == "gear and drives":
        for _ in range(2):
            m.hang(-1, "revolute")
            m.joints[-1]["drive"] = drive(m_turn(m, m.joints[-1]))
        ratio = -rng.uniform(3, 5)
        m.couplings = [{"kind": "gear", "joints": ["j0", "j1"], "ratio": ratio, "terms": [(1, "turn", 0), (-ratio, "turn", 1)]}]
    else:
        body = m.link(np.zeros(3), np.array([m.size, 0, 0]))
        m.joint("spherical", -1, body, np.zeros(3), EYE, own=True)
        joint = m.joint("spherical", -1, body, np.array([m.size, 0, 0]), EYE, own=True)
        joint["i"]["s"] = [m.size * rng.choice([0.8, 1.25]), 0, 0]
    return which


def m_turn(m, joint):
    x, a = m.pose(joint["i"]["body"])
    y, b = m.pose(joint["j"]["body"])
    a, b = a @ np.array(joint["i"]["axes"]), b @ np.array(joint["j"]["axes"])
    return math.atan2(a[:, 1] @ b[:, 0], a[:, 0] @ b[:, 0])


def m_slide(m, joint):
    (x, r), (y, s) = m.pose(joint["i"]["body"]), m.pose(joint["j"]["body"])
    d = y + s @ np.array(joint["j"]["s"]) - x - r @ np.array(joint["i"]["s"])
    return float((r @ np.array(joint["i"]["axes"]))[:, 2] @ d)


def spring_constant(m, bodies, most, turn=False):
    """Of a spring that swings the lightest of these with at most so many rad in a second."""
    lot = [m.bodies[b] for b in bodies if b >= 0]
    least = min(np.linalg.eigvalsh(b["inertia"])[0] if turn else b["mass"] for b in lot)
    return float(least * (most * m.rng.uniform(0.3, 1)) ** 2)


def laws(m, system):
    rng = m.rng
    system["springs"], system["bushings"], system["forces"], system["couplings"] = [], [], [], getattr(m, "couplings", [])
    moving = list(range(len(m.bodies)))
    if rng.uniform() < 0.6:
        direction = rng.normal(size=3)
        system["gravity"] = (9.81 * rng.choice([0.2, 1.0]) * direction / np.linalg.norm(direction)).tolist()
    else:
        system["gravity"] = [0.0, 0.0, 0.0]
    rate = lambda: rng.uniform(2, 8)
    driven = rng.uniform() < 0.3
    for joint in m.joints:
        ends = [joint["i"]["body"], joint["j"]["body"]]
        if joint["kind"] not in ("revolute", "prismatic", "cylindrical", "planar") or joint.get("spring") or joint.get("drive"):
            continue
        if joint["kind"] == "cylindrical" and rng.uniform() < 0.5:
            joint["along"] = "slide"
        turn = joint["along"] == "turn"
        at = m_turn(m, joint) if turn else m_slide(m, joint)
        loop = system["class"] not in ("tree", "points")
        if driven and not loop and rng.uniform() < 0.5:
            a, f = (rng.uniform(0.2, 1.5) if turn else 0.3 * m.size * rng.uniform()), rate()
            joint["drive"] = {"offset": at, "amplitude": a, "frequency": f} if rng.uniform() < 0.6 else {"offset": at, "rate": a}
            continue
        if rng.uniform() < 0.35:
            k = spring_constant(m, ends, 8, turn)
            joint["spring"] = {"stiffness": k, "damping": k * rng.choice([0.0, 0.02]), "free": at + (rng.uniform(-1, 1) if turn else 0.2 * m.size * rng.uniform(-1, 1)),
                               "preload": k * rng.choice([0.0, 0.1]) * (1 if turn else m.size)}
            if rng.uniform() < 0.2:
                speed = 1.0 if turn else m.size
                joint["spring"]["friction"] = {"force": 0.2 * k * speed, "rate": 0.5 * speed}
        if rng.uniform() < 0.25:
            k = spring_constant(m, ends, 4, turn) * (1 if turn else m.size)
            joint["motor"] = {"offset": k * rng.uniform(-1, 1), "amplitude": k * rng.uniform(), "frequency": rate(), "phase": rng.uniform(0, 6)}
    # A gear or a rack between two joints of a tree; a screw.
    free = [k for k, j in enumerate(m.joints) if "drive" not in j]
    hinges = [k for k in free if m.joints[k]["kind"] == "revolute"]
    slides = [k for k in free if m.joints[k]["kind"] == "prismatic"]
    screws = [k for k in free if m.joints[k]["kind"] == "cylindrical"]
    if system["class"] == "tree" and not system["couplings"]:
        if len(hinges) > 1 and rng.uniform() < 0.4:
            ratio = float(rng.choice([-1, 1]) * rng.uniform(0.3, 3))
            a, b = hinges[:2]
            system["couplings"].append({"kind": "gear", "joints": [m.joints[a]["name"], m.joints[b]["name"]], "ratio": ratio,
                                        "terms": [(1.0, "turn", a), (-ratio, "turn", b)]})
        elif hinges and slides and rng.uniform() < 0.5:
            radius = float(m.size * rng.uniform(0.1, 0.5))
            a, b = hinges[0], slides[0]
            system["couplings"].append({"kind": "rack", "joints": [m.joints[a]["name"], m.joints[b]["name"]], "radius": radius,
                                        "terms": [(1.0, "slide", b), (-radius, "turn", a)]})
        elif screws and rng.uniform() < 0.5:
            lead = float(m.size * rng.uniform(0.3, 1.5))
            a = screws[0]
            system["couplings"].append({"kind": "screw", "joint": m.joints[a]["name"], "lead": lead,
                                        "terms": [(1.0, "slide", a), (-lead / (2 * math.pi), "turn", a)]})
    # Springs and bushings between bodies, or to the ground.
    for _ in range(int(rng.choice([0, 0, 1, 2]))):
        j = int(rng.choice(moving))
        i = int(rng.choice([-1] + [b for b in moving if b != j]))
        x, r = m.pose(i)
        y, s = m.pose(j)
        at = x + r @ (rng.uniform(-1, 1, 3) * 0.3 * m.size) if i >= 0 else y + rng.normal(size=3) * m.size
        to = y + s @ (rng.uniform(-1, 1, 3) * (0 if m.bodies[j]["point"] else 0.3) * m.size)
        if np.linalg.norm(at - to) < 0.1 * m.size:
            continue
        if i >= 0 and m.bodies[i]["point"]:
            at = x
        k = spring_constant(m, [i, j], 6)
        length = float(np.linalg.norm(to - at))
        system["springs"].append({"name": f"s{len(system['springs'])}", "i": m.end(i, at, EYE), "j": m.end(j, to, EYE), "stiffness": k,
                                  "damping": k * float(rng.choice([0, 0.03])), "free": length * rng.uniform(0.5, 1.2)})
    if rng.uniform() < 0.15 and system["class"] in ("tree", "closed", "door"):
        j = int(rng.choice(moving))
        i = int(rng.choice([-1] + [b for b in moving if b != j]))
        if not m.bodies[j]["point"] and (i < 0 or not m.bodies[i]["point"]):
            y, s = m.pose(j)
            at = y + s @ (rng.uniform(-1, 1, 3) * 0.2 * m.size)
            axes = random_rotation(rng)
            k, kr = spring_constant(m, [i, j], 6), spring_constant(m, [i, j], 6, True)
            system["bushings"].append({"name": "bush", "i": m.end(i, at, axes), "j": m.end(j, at, axes), "k": (k * rng.uniform(0.3, 1, 3)).tolist(),
                                       "kr": (kr * rng.uniform(0.3, 1, 3)).tolist(), "c": (k * 0.03 * rng.uniform(0, 1, 3)).tolist(),
                                       "cr": (kr * 0.03 * rng.uniform(0, 1, 3)).tolist()})
    if rng.uniform() < 0.3:
        b = int(rng.choice(moving))
        body = m.bodies[b]
        f = rng.normal(size=3) * body["mass"] * m.size * 5
        system["forces"].append({"body": b, "s": (rng.uniform(-1, 1, 3) * (0 if body["point"] else 0.2) * m.size).tolist(), "force": f.tolist(),
                                 "follower": bool(rng.uniform() < 0.5), "history": {"offset": 1.0} if rng.uniform() < 0.5 else {"amplitude": 1.0, "frequency": rate()}})


def grounded(m):
    return any(j["i"]["body"] < 0 for j in m.joints)


def system(seed):
    """A dict in SI units: bodies with a place of the center of mass, joints and laws, and where the scene puts it."""
    rng = np.random.default_rng([20261128, seed])
    for _ in range(50):
        m = Maker(rng)
        kind = str(rng.choice(CLASSES, p=SHARES))
        makers = {"tree": tree, "closed": closed, "four-bar": four_bar, "chain loop": chain_loop, "parallelogram": parallelogram, "bennett": bennett,
                  "platform": platform, "door": door, "slider-crank": slider_crank, "points": points, "impossible": impossible}
        try:
            detail = makers[kind](m)
            break
        except ValueError:
            continue
    out = {"seed": seed, "class": kind, "detail": str(detail) if detail else "", "size": float(m.size), "tolerance": float(rng.choice(TOLERANCES))}
    laws(m, out)
    out["end"] = float(rng.uniform(0.15, 0.6))
    n = len(m.bodies)
    # A free system may be fast; every one far.
    out["far"] = (rng.normal(size=3) * float(rng.choice([0, 0, 0, 0, 1e5, 1e6, 1e7]))).tolist() if rng.uniform() < 0.6 else [0.0, 0.0, 0.0]
    tied = grounded(m) or any(s["i"]["body"] < 0 for s in out["springs"] + out["bushings"])
    out["fast"] = (lambda d: (d / np.linalg.norm(d) * float(rng.choice([300, 7500]))).tolist())(rng.normal(size=3)) if not tied and rng.uniform() < 0.5 else [0.0] * 3
    speed, spin = m.size * rng.choice([0, 1, 3]), rng.choice([0, 1, 4])
    for body in m.bodies:
        body["attitude"] = reference.quaternion(body["matrix"]).tolist()
        body["velocity"] = (rng.normal(size=3) * speed).tolist()
        body["omega"] = (rng.normal(size=3) * spin).tolist()
        if body["point"] and not any(j["kind"] != "spherical" for j in m.joints):
            body["omega"] = [0.0, 0.0, 0.0]
        body["place"] = body["place"].tolist()
        del body["matrix"]
    out["bodies"], out["joints"] = m.bodies, m.joints
    if kind != "impossible":
        # Velocities that all rows allow.
        ref = reference.Reference(out)
        x, q, v, w, _ = ref.split(ref.close(0.0, ref.start(m.bodies), places=False)[0])
        for k, body in enumerate(m.bodies):
            body["velocity"] = v[k].tolist()
            body["omega"] = (reference.rotation(q[k]).T @ w[k]).tolist()
    out["order"] = [int(k) for k in rng.permutation(len(m.joints))]
    out["units"] = int(rng.choice(len(UNITS), p=[0.4, 0.2, 0.1, 0.1, 0.1, 0.1]))
    out["thrown"] = 0.0
    if kind != "impossible" and rng.uniform() < 0.15 and all(j["style"] == "own" for j in m.joints):
        out["thrown"] = float(10 ** rng.uniform(-5, -2))
    out["throw"] = (rng.normal(size=(n, 6)) * out["thrown"]).tolist()
    out["turned"] = None
    drives = [k for k, j in enumerate(m.joints) if "drive" in j and j["along"] == "turn" and j["kind"] == "revolute" and j["style"] == "own"]
    if kind == "tree" and len(m.bodies) == 1 and drives and rng.uniform() < 0.7:
        # The drive begins at half a turn, the scene does not.
        joint = m.joints[drives[0]]
        out["turned"] = float(math.pi * rng.choice([-1, 1]))
        joint["drive"]["offset"] += out["turned"]
    return out


def number(value):
    return repr(float(value))


def text_of(vector):
    return "[" + ", ".join(number(v) for v in vector) + "]"


def formula(history):
    parts = []
    if history.get("offset", 0.0):
        parts.append(f"({number(history['offset'])})")
    if history.get("rate", 0.0):
        parts.append(f"({number(history['rate'])})*t")
    if history.get("amplitude", 0.0):
        parts.append(f"({number(history['amplitude'])})*sin(({number(history.get('frequency', 0.0))})*t + ({number(history.get('phase', 0.0))}))")
    return " + ".join(parts) or "0*t"


def in_units(history, factor, second):
    out = dict(history)
    for key, power in (("offset", 0), ("amplitude", 0), ("rate", -1)):
        if key in out:
            out[key] = out[key] * factor * second ** -power
    if "frequency" in out:
        out["frequency"] *= second
    return out


def scene(system):
    """The scene of a system in its units, and the starts of its bodies in SI as the scene says them (without place and speed of all)."""
    name_l, metre, name_m, kilogram, name_t, second = UNITS[system["units"]]
    length, mass, time = 1 / metre, 1 / kilogram, second  # a second has 1/second units
    per_t = second
    n = len(system["bodies"])
    markers = {k: [] for k in range(-1, n)}
    far, fast = np.array(system["far"]), np.array(system["fast"])

    def marker(end, axes):
        b = end["body"]
        label = f"m{len(markers[b])}"
        at = np.array(end["s"]) + (far if b < 0 else np.array(system["bodies"][b]["com"]))
        line = f"at = {text_of(at * length)}"
        if axes:
            a = np.array(end["axes"])
            line += f", z = {text_of(a[:, 2])}, x = {text_of(a[:, 0])}"
        markers[b].append(f"{label} = {{ {line} }}")
        return f'"{"ground" if b < 0 else system["bodies"][b]["name"]}.{label}"'

    tail, starts = [], []
    force, torque = mass * length * per_t**2, mass * length**2 * per_t**2
    for k in system["order"]:
        joint = system["joints"][k]
        own = joint["style"] == "own"
        tail += ["", "[[joints]]", f'name = "{joint["name"]}"', f'kind = "{joint["kind"]}"',
                 f"between = [{marker(joint['i'], own)}, {marker(joint['j'], own)}]"]
        if not own and joint["kind"] not in ("fixed", "spherical"):
            b = joint["i"]["body"]
            z = np.array(joint["i"]["axes"])[:, 2]
            tail.append(f"axis = {text_of(z if b < 0 else reference.rotation(system['bodies'][b]['attitude']) @ z)}")
        turn = joint["along"] == "turn"
        unit, effort = (1.0, torque) if turn else (length, force)
        along = f'along = "{joint["along"]}", '
        if joint.get("drive"):
            f = formula(in_units(joint["drive"], unit, per_t))
            tail.append(f'drive = {{ {along}amplitude = 1.0, history = {{ kind = "expression", formula = "{f}" }} }}')
        if joint.get("spring"):
            s = joint["spring"]
            stiff = effort / unit
            line = f"stiffness = {number(s['stiffness'] * stiff)}, damping = {number(s['damping'] * stiff / per_t)}, free = {number(s['free'] * unit)}"
            line += f", preload = {number(s.get('preload', 0.0) * effort)}"
            if "friction" in s:
                line += f", friction = {{ force = {number(s['friction']['force'] * effort)}, rate = {number(s['friction']['rate'] * unit * per_t)} }}"
            tail.append(f"spring = {{ {along}{line} }}")
        if joint.get("motor"):
            f = formula(in_units(joint["motor"], effort, per_t))
            tail.append(f'motor = {{ {along}amplitude = 1.0, history = {{ kind = "expression", formula = "{f}" }} }}')
    for c in system["couplings"]:
        tail += ["", "[[couplings]]", f'name = "c"', f'kind = "{c["kind"]}"']
        if c["kind"] == "screw":
            tail += [f'joint = "{c["joint"]}"', f"lead = {number(c['lead'] * length)}"]
        else:
            tail.append(f'joints = ["{c["joints"][0]}", "{c["joints"][1]}"]')
            tail.append(f"ratio = {number(c['ratio'])}" if c["kind"] == "gear" else f"radius = {number(c['radius'] * length)}")
    for s in system["springs"]:
        tail += ["", "[[springs]]", f'name = "{s["name"]}"', f"between = [{marker(s['i'], False)}, {marker(s['j'], False)}]",
                 f"stiffness = {number(s['stiffness'] * force / length)}", f"damping = {number(s['damping'] * force / length / per_t)}",
                 f"free_length = {number(s['free'] * length)}"]
    for s in system["bushings"]:
        scaled = lambda key, factor: text_of(np.array(s[key]) * factor)
        tail += ["", "[[bushings]]", f'name = "{s["name"]}"', f"between = [{marker(s['i'], True)}, {marker(s['j'], True)}]",
                 f"stiffness = {{ translation = {scaled('k', force / length)}, rotation = {scaled('kr', torque)} }}",
                 f"damping = {{ translation = {scaled('c', force / length / per_t)}, rotation = {scaled('cr', torque / per_t)} }}"]
    head = [f'title = "seed {system["seed"]}, {system["class"]}"', f'units = {{ length = "{name_l}", mass = "{name_m}", time = "{name_t}" }}']
    for k, body in enumerate(system["bodies"]):
        x, q = np.array(body["place"]), np.array(body["attitude"])
        r = reference.rotation(q)
        if system["thrown"]:
            x = x + system["size"] * np.array(system["throw"][k][:3])
            q = reference.product(reference.small_turn(np.array(system["throw"][k][3:])), q)
        starts.append((x, q))
        r = reference.rotation(q)
        com = np.array(body["com"])
        origin = x - r @ com + far
        inertia = np.array(body["inertia"]) * mass * length**2
        head += ["", f"[bodies.{body['name']}]",
                 f"rigid = {{ mass = {number(body['mass'] * mass)}, center_of_mass = {text_of(com * length)}, inertia = [{', '.join(text_of(row) for row in inertia)}] }}",
                 f"initial = {{ position = {text_of(origin * length)}, attitude = {text_of(q)}, velocity = {text_of((np.array(body['velocity']) + fast) * length * per_t)}, angular_velocity = {text_of(np.array(body['omega']) * per_t)} }}"]
        if markers[k]:
            head.append(f"markers = {{ {', '.join(markers[k])} }}")
        loads = []
        g = np.array(system["gravity"])
        if np.any(g):
            size = np.linalg.norm(g)
            loads.append(f'{{ kind = "gravity", direction = {text_of(g / size)}, amplitude = {number(size * length * per_t**2)} }}')
        for load in system["forces"]:
            if load["body"] == k:
                f = np.array(load["force"])
                size = np.linalg.norm(f)
                h = formula(in_units(load["history"], 1.0, per_t))
                loads.append(f'{{ kind = "force", at = {text_of((np.array(load["s"]) + com) * length)}, direction = {text_of(f / size)}, amplitude = {number(size * force)}, '
                             f'frame = "{"body" if load["follower"] else "global"}", history = {{ kind = "expression", formula = "{h}" }} }}')
        if loads:
            head.append(f"loads = [{', '.join(loads)}]")
    if markers[-1]:
        head += ["", "[ground]", f"markers = {{ {', '.join(markers[-1])} }}"]
    end = system["end"] / second
    tail += ["", "[time]", f"end = {number(end)}", f"tolerance = {system['tolerance']}", "", "[output]", f"interval = {number(end / 4)}", ""]
    return "\n".join(head + tail), starts
