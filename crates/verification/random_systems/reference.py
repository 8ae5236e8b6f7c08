"""Rigid bodies in joints in maximal coordinates: an own reference, which shares no idea with the program.

States are places of the centers of mass, quaternions, velocities and angular velocities, all global. Accelerations follow from
M a = f + G' lambda and the second derivatives of all rows. Rows that others imply are found by the singular values of G, with turns in units of
the size and without any mass. DOP853 goes from output to output; there places and velocities are closed again (Gauss-Newton).
"""

import math

import numpy as np
from scipy.integrate import DOP853

# Singular values below this part of the largest one count as zero.
RANK = 1e-8
# Where the least that counts is below NEAR, or the largest that does not above DROPPED, the motion is not determined well.
NEAR, DROPPED = 1e-4, 1e-5
# Stages of a step are off the rows by little, closed states are not: there what is implied stays so to rounding.
SAME = 1e-11


class Unsure(Exception):
    """The reference cannot say what is right."""


def cross(a, b):
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    out[..., 0] = a[..., 1] * b[..., 2] - a[..., 2] * b[..., 1]
    out[..., 1] = a[..., 2] * b[..., 0] - a[..., 0] * b[..., 2]
    out[..., 2] = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return out


def cross3(a, b):
    """Of two single vectors, fast."""
    (ax, ay, az), (bx, by, bz) = a, b
    return np.array((ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx))


def dot(a, b):
    return (a * b).sum(-1)


def rotation(q):
    """Matrices of unit quaternions (w, x, y, z), body to global."""
    w, x, y, z = np.moveaxis(np.asarray(q, float), -1, 0)
    out = np.empty((*w.shape, 3, 3))
    out[..., 0, 0], out[..., 0, 1], out[..., 0, 2] = 1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)
    out[..., 1, 0], out[..., 1, 1], out[..., 1, 2] = 2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)
    out[..., 2, 0], out[..., 2, 1], out[..., 2, 2] = 2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)
    return out


def quaternion(matrix):
    """The quaternion of a rotation matrix: the eigenvector of the largest eigenvalue of Davenport's matrix."""
    m = matrix
    k = np.array(
        [
            [m[0, 0] + m[1, 1] + m[2, 2], m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1]],
            [0, m[0, 0] - m[1, 1] - m[2, 2], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0]],
            [0, 0, m[1, 1] - m[0, 0] - m[2, 2], m[1, 2] + m[2, 1]],
            [0, 0, 0, m[2, 2] - m[0, 0] - m[1, 1]],
        ]
    )
    return np.linalg.eigh(k, UPLO="U")[1][:, -1]


def product(p, q):
    return np.concatenate(
        (
            p[..., :1] * q[..., :1] - dot(p[..., 1:], q[..., 1:])[..., None],
            p[..., :1] * q[..., 1:] + q[..., :1] * p[..., 1:] + cross(p[..., 1:], q[..., 1:]),
        ),
        -1,
    )


def small_turn(vector):
    angle = np.linalg.norm(vector, axis=-1, keepdims=True)
    return np.concatenate((np.cos(angle / 2), 0.5 * np.sinc(angle / (2 * math.pi)) * vector), -1)


def rotation_vector(matrix):
    q = quaternion(matrix)
    if q[0] < 0:
        q = -q
    sine = np.linalg.norm(q[1:])
    return 2 * q[1:] if sine < 1e-9 else 2 * math.atan2(sine, q[0]) / sine * q[1:]


def skew(a):
    return np.array([[0, -a[2], a[1]], [a[2], 0, -a[0]], [-a[1], a[0], 0]])


class Reference:
    """The equations of a system as `generate.py` describes it."""

    def __init__(self, system):
        self.n = n = len(system["bodies"])
        bodies = system["bodies"]
        self.length = system["size"]
        self.mass = np.array([b["mass"] for b in bodies])
        self.inertia = np.array([b["inertia"] for b in bodies])
        self.inverse = np.linalg.inv(self.inertia)
        values, vectors = np.linalg.eigh(self.inertia)
        # J^(-1/2), body axes.
        self.root = np.einsum("nij,nj,nkj->nik", vectors, values**-0.5, vectors)
        self.gravity = np.array(system.get("gravity", [0, 0, 0]), float)
        self.forces = system.get("forces", [])
        self.springs = system.get("springs", [])
        self.bushings = system.get("bushings", [])
        self.joints = system["joints"]
        # Joints whose turn is counted: a state of its own.
        self.counted = [k for k, j in enumerate(self.joints) if j["kind"] in ("revolute", "cylindrical", "planar")
                        and (j.get("spring") or j.get("motor")) and j.get("along", "turn") == "turn"]
        points, angles, self.coupled = [], [], []
        for joint in self.joints:
            points += self.point_rows(joint)
            angles += self.angle_rows(joint)
        for coupling in system.get("couplings", []):
            self.coupled.append([(factor, coordinate, self.joints[k]) for factor, coordinate, k in coupling["terms"]])
        # The ground is the last body.
        place = lambda end: (end["body"] if end["body"] >= 0 else n)
        self.p_i = np.array([place(r[0]) for r in points], int)
        self.p_j = np.array([place(r[1]) for r in points], int)
        self.p_si = np.array([r[0]["s"] for r in points], float).reshape(-1, 3)
        self.p_sj = np.array([r[1]["s"] for r in points], float).reshape(-1, 3)
        self.p_e = np.array([r[2] for r in points], float).reshape(-1, 3)
        self.p_drive = [(k, r[3]) for k, r in enumerate(points) if r[3]]
        self.a_i = np.array([place(r[0]) for r in angles], int)
        self.a_j = np.array([place(r[1]) for r in angles], int)
        self.a_u = np.array([r[2] for r in angles], float).reshape(-1, 3)
        self.a_u1 = np.array([r[3] for r in angles], float).reshape(-1, 3)
        self.a_b = np.array([r[4] for r in angles], float).reshape(-1, 3)
        self.a_drive = [(k, r[5]) for k, r in enumerate(angles) if r[5]]
        self.rows = len(points) + len(angles) + len(self.coupled)
        self.least, self.rank, self.dropped, self.combined = 1.0, None, 0.0, None

    @staticmethod
    def point_rows(joint):
        i, j, axes = joint["i"], joint["j"], np.array(joint["i"]["axes"])
        which = {"fixed": "xyz", "revolute": "xyz", "spherical": "xyz", "universal": "xyz", "prismatic": "xy",
                 "cylindrical": "xy", "planar": "z"}[joint["kind"]]
        rows = [(i, j, axes[:, "xyz".index(k)], None) for k in which]
        if joint.get("drive") and joint["along"] == "slide":
            rows.append((i, j, axes[:, 2], joint["drive"]))
        return rows

    @staticmethod
    def angle_rows(joint):
        i, j = joint["i"], joint["j"]
        a, b = np.array(i["axes"]), np.array(j["axes"])
        pairs = {"fixed": [(0, 1), (1, 2), (2, 0)], "prismatic": [(0, 1), (1, 2), (2, 0)], "revolute": [(0, 2), (1, 2)],
                 "cylindrical": [(0, 2), (1, 2)], "planar": [(0, 2), (1, 2)], "universal": [(0, 1)], "spherical": []}[joint["kind"]]
        none = np.zeros(3)
        rows = [(i, j, a[:, k], none, b[:, m], None) for k, m in pairs]
        if joint.get("drive") and joint["along"] == "turn":
            rows.append((i, j, a[:, 0], a[:, 1], b[:, 1], joint["drive"]))
        return rows

    # States.

    def split(self, y):
        n = self.n
        x = np.zeros((n + 1, 3))
        q = np.zeros((n + 1, 4))
        v, w = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
        x[:n] = y[: 3 * n].reshape(n, 3)
        q[:n] = y[3 * n : 7 * n].reshape(n, 4)
        q[n, 0] = 1
        v[:n] = y[7 * n : 10 * n].reshape(n, 3)
        w[:n] = y[10 * n : 13 * n].reshape(n, 3)
        q /= np.linalg.norm(q, axis=1, keepdims=True)
        return x, q, v, w, y[13 * n :]

    @staticmethod
    def pack(x, q, v, w, turns, n):
        return np.concatenate((x[:n].ravel(), q[:n].ravel(), v[:n].ravel(), w[:n].ravel(), turns))

    def turn(self, joint, r):
        """The angle about z from the x axis of the first end to that of the second."""
        i, j = joint["i"], joint["j"]
        a = r[i["body"]] @ np.array(i["axes"])
        b = r[j["body"]] @ np.array(j["axes"])
        return math.atan2(a[:, 1] @ b[:, 0], a[:, 0] @ b[:, 0])

    def start(self, bodies):
        n = self.n
        q = np.array([b["attitude"] for b in bodies])
        r = np.concatenate((rotation(q), np.eye(3)[None]))
        w = np.einsum("nij,nj->ni", r[:n], np.array([b["omega"] for b in bodies]))
        turns = np.array([self.turn(self.joints[k], r) for k in self.counted])
        return self.pack(np.array([b["place"] for b in bodies]), q, np.array([b["velocity"] for b in bodies]), w, turns, n)

    # Rows: residual, matrix, wanted rate, and what the second derivative has beside G a.

    def constraints(self, t, x, r, v, w):
        n, m, np_, na = self.n, self.rows, len(self.p_i), len(self.a_i)
        g = np.zeros((m, n + 1, 6))
        phi, rate, beside = np.zeros(m), np.zeros(m), np.zeros(m)
        if np_:
            i, j = self.p_i, self.p_j
            ri = (r[i] @ self.p_si[:, :, None])[:, :, 0]
            rj = (r[j] @ self.p_sj[:, :, None])[:, :, 0]
            e = (r[i] @ self.p_e[:, :, None])[:, :, 0]
            far = x[j] + rj - x[i]
            d = far - ri
            wi, wj = w[i], w[j]
            k = np.arange(np_)
            g[k, j, :3] += e
            g[k, j, 3:] += cross(rj, e)
            g[k, i, :3] -= e
            g[k, i, 3:] -= cross(far, e)
            phi[:np_] = dot(e, d)
            e1 = cross(wi, e)
            d1 = v[j] + cross(wj, rj) - v[i] - cross(wi, ri)
            beside[:np_] = dot(e, cross(wj, cross(wj, rj)) - cross(wi, cross(wi, ri))) + 2 * dot(e1, d1) + dot(cross(wi, e1), d)
            for row, drive in self.p_drive:
                value, first, second = drive_values(drive, t)
                phi[row] -= value
                rate[row] = first
                beside[row] -= second
        if na:
            i, j = self.a_i, self.a_j
            u0, u1 = self.a_u, np.zeros_like(self.a_u)
            first, second = np.zeros((na, 1)), np.zeros((na, 1))
            if self.a_drive:
                u0 = u0.copy()
                for row, drive in self.a_drive:
                    value, first[row], second[row] = drive_values(drive, t)
                    u0[row] = math.cos(value) * self.a_u[row] + math.sin(value) * self.a_u1[row]
                    u1[row] = -math.sin(value) * self.a_u[row] + math.cos(value) * self.a_u1[row]
            u = (r[i] @ u0[:, :, None])[:, :, 0]
            s = (r[i] @ u1[:, :, None])[:, :, 0]
            b = (r[j] @ self.a_b[:, :, None])[:, :, 0]
            wi, wj = w[i], w[j]
            k = np.arange(na) + np_
            normal = cross(u, b)
            g[k, i, 3:] += normal
            g[k, j, 3:] -= normal
            phi[k] = dot(u, b)
            rate[k] = -first[:, 0] * dot(s, b)
            b1 = cross(wj, b)
            of_u = cross(wi, u)
            beside[k] = dot(cross(wi, of_u) + 2 * first * cross(wi, s) - first**2 * u + second * s, b) \
                + 2 * dot(of_u + first * s, b1) + dot(u, cross(wj, b1))
        for c, terms in enumerate(self.coupled):
            row = np_ + na + c
            for factor, coordinate, joint in terms:
                i, j = joint["i"]["body"], joint["j"]["body"]
                z = r[i] @ np.array(joint["i"]["axes"])[:, 2]
                if coordinate == "turn":
                    g[row, j, 3:] += factor * z
                    g[row, i, 3:] -= factor * z
                    beside[row] += factor * cross3(w[i], z) @ (w[j] - w[i])
                else:
                    ri, rj = r[i] @ np.array(joint["i"]["s"]), r[j] @ np.array(joint["j"]["s"])
                    d = x[j] + rj - x[i] - ri
                    z1, d1 = cross3(w[i], z), v[j] + cross3(w[j], rj) - v[i] - cross3(w[i], ri)
                    g[row, j, :3] += factor * z
                    g[row, j, 3:] += factor * cross3(rj, z)
                    g[row, i, :3] -= factor * z
                    g[row, i, 3:] -= factor * cross3(ri + d, z)
                    beside[row] += factor * (z @ (cross3(w[j], cross3(w[j], rj)) - cross3(w[i], cross3(w[i], ri)))
                                             + 2 * z1 @ d1 + cross3(w[i], z1) @ d)
        return phi, g[:, :n].reshape(m, 6 * n), rate, beside

    def scaled(self, g):
        """The matrix of the rows with turns in units of the size."""
        scale = np.tile(np.concatenate((np.ones(3), np.full(3, 1 / self.length))), self.n)
        return g * scale, scale

    def independent(self, g):
        """Combinations of rows that none implies, by the geometry alone."""
        u, s, _ = np.linalg.svd(self.scaled(g)[0], full_matrices=False)
        if self.rank is None:
            self.rank = int(np.sum(s > RANK * s[0]))
        rank = self.rank
        self.least = min(self.least, s[rank - 1] / s[0])
        if rank < len(s):
            self.dropped = max(self.dropped, s[rank] / s[0])
        if self.least < NEAR or self.dropped > DROPPED:
            raise Unsure("rows are implied at one place and not at another: branches or a lock")
        return u[:, :rank]

    # Forces and moments on each body, global, about its center of mass.

    def wrenches(self, t, x, r, v, w, turns):
        n = self.n
        force, moment = np.zeros((n + 1, 3)), np.zeros((n + 1, 3))
        force[:n] += self.mass[:, None] * self.gravity

        def push(body, at, f):
            force[body] += f
            moment[body] += cross3(at - x[body], f)

        for load in self.forces:
            b = load["body"]
            arm = r[b] @ np.array(load["s"])
            f = np.array(load["force"]) * drive_values(load["history"], t)[0]
            push(b, x[b] + arm, r[b] @ f if load["follower"] else f)

        def ends(of):
            i, j = of["i"]["body"], of["j"]["body"]
            ri, rj = r[i] @ np.array(of["i"]["s"]), r[j] @ np.array(of["j"]["s"])
            return i, j, x[i] + ri, x[j] + rj, v[i] + cross3(w[i], ri), v[j] + cross3(w[j], rj)

        for spring in self.springs:
            i, j, xi, xj, vi, vj = ends(spring)
            d = xj - xi
            length = np.linalg.norm(d)
            along = d / length
            pull = spring["stiffness"] * (length - spring["free"]) + spring["damping"] * along @ (vj - vi)
            push(i, xi, pull * along)
            push(j, xj, -pull * along)
        for bushing in self.bushings:
            i, j, xi, xj, vi, vj = ends(bushing)
            axes = r[i] @ np.array(bushing["i"]["axes"])
            d = xj - xi
            rate = axes.T @ (vj - vi - cross3(w[i], d))
            f = axes @ (np.array(bushing["k"]) * (axes.T @ d) + np.array(bushing["c"]) * rate)
            push(i, xj, f)
            push(j, xj, -f)
            turned = rotation_vector(axes.T @ r[j] @ np.array(bushing["j"]["axes"]))
            angle = np.linalg.norm(turned)
            factor = 1 / 12 if angle < 1e-4 else 1 / angle**2 - (1 + math.cos(angle)) / (2 * angle * math.sin(angle))
            s = skew(turned)
            # The turn vector changes by the inverse of the left Jacobian of a turn in the axes of the first end.
            inverse = np.eye(3) - 0.5 * s + factor * s @ s
            m = axes @ (inverse.T @ (np.array(bushing["kr"]) * turned) + np.array(bushing["cr"]) * (axes.T @ (w[j] - w[i])))
            moment[i] += m
            moment[j] -= m
        for k, joint in enumerate(self.joints):
            spring, motor = joint.get("spring"), joint.get("motor")
            if not spring and not motor:
                continue
            i, j, xi, xj, vi, vj = ends(joint)
            z = r[i] @ np.array(joint["i"]["axes"])[:, 2]
            if joint["along"] == "turn":
                value, rate = turns[self.counted.index(k)], z @ (w[j] - w[i])
            else:
                d = xj - xi
                value, rate = z @ d, z @ (vj - vi - cross3(w[i], d))
            f = 0.0
            if spring:
                f += spring.get("preload", 0) - spring["stiffness"] * (value - spring["free"]) - spring["damping"] * rate
                if "friction" in spring:
                    f -= spring["friction"]["force"] * math.tanh(rate / spring["friction"]["rate"])
            if motor:
                f += drive_values(motor, t)[0]
            if joint["along"] == "turn":
                moment[j] += f * z
                moment[i] -= f * z
            else:
                push(j, xj, f * z)
                push(i, xj, -f * z)
        return force[:n], moment[:n]

    def rates(self, t, y):
        n = self.n
        self.calls += 1
        if self.calls > self.most:
            raise Unsure("too many evaluations")
        x, q, v, w, turns = self.split(y)
        r = rotation(q)
        force, moment = self.wrenches(t, x, r, v, w, turns)
        rb, wb = r[:n], w[:n]
        back = rb.transpose(0, 2, 1)
        turn = lambda inertia, by: (rb @ (inertia @ (back @ by[:, :, None])))[:, :, 0]
        spin = turn(self.inertia, wb)
        acceleration = np.concatenate((force / self.mass[:, None], turn(self.inverse, moment - cross(wb, spin))), 1).ravel()
        if self.rows:
            _, g, _, beside = self.constraints(t, x, r, v, w)
            if self.combined is None:
                self.combined = self.independent(g)
            u = self.combined
            g = u.T @ g
            wanted = -(u.T @ beside) - g @ acceleration
            # M^(-1/2) on the right of G.
            by = g.reshape(-1, n, 6)
            turned = rb @ self.root
            b = np.concatenate((by[:, :, :3] * self.mass[:, None] ** -0.5, (by[:, :, None, 3:] @ turned)[:, :, 0]), 2)
            b = b.reshape(len(g), 6 * n)
            basis, upper = np.linalg.qr(b.T)
            z = (basis @ np.linalg.solve(upper.T, wanted)).reshape(n, 6)
            acceleration = acceleration + np.concatenate(
                (z[:, :3] * self.mass[:, None] ** -0.5, (turned @ z[:, 3:, None])[:, :, 0]), 1
            ).ravel()
        a = acceleration.reshape(n, 6)
        q1 = 0.5 * product(np.concatenate((np.zeros((n, 1)), wb), 1), q[:n])
        turning = [
            r[j["i"]["body"]] @ np.array(j["i"]["axes"])[:, 2] @ (w[j["j"]["body"]] - w[j["i"]["body"]])
            for j in (self.joints[k] for k in self.counted)
        ]
        return np.concatenate((v[:n].ravel(), q1.ravel(), a[:, :3].ravel(), a[:, 3:].ravel(), turning))

    def close(self, t, y, places=True):
        """Places and velocities that satisfy all rows, next to those given; what is left off, over the size."""
        x, q, v, w, turns = self.split(y)
        n = self.n
        if self.rows and places:
            for _ in range(20):
                phi, g, _, _ = self.constraints(t, x, rotation(q), v, w)
                if np.abs(phi).max() < 1e-14 * self.length:
                    break
                scaled, scale = self.scaled(g)
                step = -(scale * (np.linalg.pinv(scaled, rcond=RANK) @ phi)).reshape(n, 6)
                x[:n] += step[:, :3]
                q[:n] = product(small_turn(step[:, 3:]), q[:n])
        off = 0.0
        if self.rows:
            phi, g, rate, _ = self.constraints(t, x, rotation(q), v, w)
            off = np.abs(phi).max()
            scaled, scale = self.scaled(g)
            both = np.concatenate((v[:n], w[:n]), 1).ravel()
            both = (both - scale * (np.linalg.pinv(scaled, rcond=RANK) @ (g @ both - rate))).reshape(n, 6)
            v[:n], w[:n] = both[:, :3], both[:, 3:]
        return self.pack(x, q, v, w, turns, n), off

    def implied(self, y):
        """The largest singular value of those that count as zero, over the largest of all, in a closed state."""
        x, q, v, w, _ = self.split(y)
        if not self.rows:
            return 0.0
        s = np.linalg.svd(self.scaled(self.constraints(0.0, x, rotation(q), v, w)[1])[0], compute_uv=False)
        rank = self.rank or int(np.sum(s > RANK * s[0]))
        return s[rank] / s[0] if rank < len(s) else 0.0

    def residual(self, t, y):
        """The largest residual of a row, and of its rate, over the size."""
        x, q, v, w, _ = self.split(y)
        if not self.rows:
            return 0.0, 0.0
        phi, g, rate, _ = self.constraints(t, x, rotation(q), v, w)
        both = np.concatenate((v[: self.n], w[: self.n]), 1).ravel()
        return np.abs(phi).max(), np.abs(g @ both - rate).max()

    def run(self, y, times, rtol, most=40000):
        """States at the times, of which the first is that of y."""
        self.calls, self.most = 0, most
        n = self.n
        found = [y]
        speed = max(np.abs(y[7 * n : 13 * n]).max(), self.length)
        atol = np.concatenate((np.full(3 * n, self.length), np.ones(4 * n), np.full(6 * n, speed), np.ones(len(y) - 13 * n))) * rtol
        for start, end in zip(times, times[1:]):
            self.combined = None
            scheme = DOP853(self.rates, start, y, end, rtol=rtol, atol=atol)
            while scheme.status == "running":
                # The combinations of rows are chosen anew for each step: on the motion any that are independent give the same.
                self.combined = None
                scheme.step()
            if scheme.status != "finished" or not np.all(np.isfinite(scheme.y)):
                raise Unsure("the reference does not get on")
            y, _ = self.close(end, scheme.y)
            if self.implied(y) > SAME:
                raise Unsure("rows are implied at one place and not at another: branches or a lock")
            found.append(y)
        return np.array(found)

    def energy(self, y):
        """Kinetic energy, and that of the place in gravity."""
        x, q, v, w, _ = self.split(y)
        n = self.n
        body = np.einsum("nba,nb->na", rotation(q)[:n], w[:n])
        return 0.5 * self.mass @ dot(v[:n], v[:n]) + 0.5 * np.einsum("na,nab,nb->", body, self.inertia, body) \
            - self.mass @ (x[:n] @ self.gravity)


def drive_values(history, t):
    """Value and two rates of offset + rate t + amplitude sin(frequency t + phase)."""
    a, f, p = history.get("amplitude", 0.0), history.get("frequency", 0.0), history.get("phase", 0.0)
    s, c = math.sin(f * t + p), math.cos(f * t + p)
    rate = history.get("rate", 0.0)
    return history.get("offset", 0.0) + rate * t + a * s, rate + a * f * c, -a * f * f * s


def distance(one, other, n, size, point_like):
    """The largest error of a place over the size, and of an attitude in rad, at any time; point-like bodies have no attitude."""
    place = turn = 0.0
    for a, b in zip(one, other):
        place = max(place, np.abs(np.linalg.norm((a[: 3 * n] - b[: 3 * n]).reshape(n, 3), axis=1)).max() / size)
        p, q = a[3 * n : 7 * n].reshape(n, 4), b[3 * n : 7 * n].reshape(n, 4)
        for k in range(n):
            if not point_like[k]:
                u, v = p[k] / np.linalg.norm(p[k]), q[k] / np.linalg.norm(q[k])
                turn = max(turn, 2 * min(np.linalg.norm(u - v), np.linalg.norm(u + v)))
    return place, turn
