"""Right-hand side of the closed loop, all agents at once.

The state is one flat vector: q, dq, the vectors of the reference, theta_hat
and the integral of s^T K s, agent after agent within each block.  Parameter
vectors of different length are padded with zeros.

The vectors of the reference are z, z', .., z^(l-1), or the filter's for the
baseline.  The designs with accelerations, (3) and (23), are integrated as
they are printed: z and z' are state, and z'' gets the acceleration that the
plant has under the torque of the moment, which needs z' and not z''.
"""

import numpy as np

from problem import (as_matrix, dimension, reference_of, reference_start, reference_vectors)


class ClosedLoop:
    def __init__(self, problem):
        agents = problem["agents"]
        self.n = len(agents)
        self.m = dimension(agents[0]["robot"])
        reference = reference_of(problem)
        self.kind = reference["kind"]
        self.filter_s = reference.get("filter_s")
        self.l = reference_vectors(problem)
        self.p = max(len(a["robot"]["theta"]) for a in agents)
        self.sizes = [len(a["robot"]["theta"]) for a in agents]
        n, m, l, p = self.n, self.m, self.l, self.p

        kinds = [a["robot"]["kind"] for a in agents]
        self.arms = np.array([i for i, k in enumerate(kinds) if k == "planar_arm"], dtype=int)
        self.masses = np.array([i for i, k in enumerate(kinds) if k == "point_mass"], dtype=int)

        self.theta = np.zeros((n, p))
        self.K = np.zeros((n, m, m))
        self.Gamma = np.zeros((n, p, p))
        self.Gamma_inverse = np.zeros((n, p, p))
        alpha = np.ones((l + 1, n))
        velocity_gain = np.zeros(n)
        self.manipulability = np.zeros((n, 1))
        start = np.zeros((2 + l, n, m))
        theta_start = np.zeros((n, p))
        for i, a in enumerate(agents):
            size = self.sizes[i]
            self.theta[i, :size] = a["robot"]["theta"]
            self.K[i] = as_matrix(a["K"], m)
            if not a["knows_theta"]:
                Gamma = as_matrix(a["Gamma"], size)
                self.Gamma[i, :size, :size] = Gamma
                self.Gamma_inverse[i, :size, :size] = np.linalg.inv(Gamma)
            self.manipulability[i] = a.get("lambda", 0.0)
            if self.kind != "backstepping":
                alpha[:l, i] = a["alpha"]
                velocity_gain[i] = a["alpha"][0] / a["roots"][0]
            start[0, i] = a["start"]["q"]
            start[1, i] = a["start"]["dq"]
            theta_start[i, :size] = a["start"]["theta_hat"]
        start[2:] = np.array(reference_start(problem)).swapaxes(0, 1)
        if problem["exchange"] == "position":
            velocity_gain[:] = 0.0
        self.alpha = alpha[:, :, None]
        # Gain of (q_j, dq_j) at receiver i.
        self.message_gain = np.stack([alpha[0], velocity_gain], axis=1)
        self.inverse_mass = 1.0 / self.theta[self.masses, 0]

        self.motion_size = (2 + l) * n * m
        self.theta_end = self.motion_size + n * p
        self.start = np.concatenate([start.ravel(), theta_start.ravel(), np.zeros(n)])

    def unpack(self, y):
        motion = y[: self.motion_size].reshape(2 + self.l, self.n, self.m)
        theta_hat = y[self.motion_size : self.theta_end].reshape(self.n, self.p)
        return motion, theta_hat, y[self.theta_end :]

    def asked(self, y, heard, total_weight):
        """z and dz; dz of order one is left to `rate`."""
        motion, _, _ = self.unpack(y)
        if self.kind != "backstepping":
            return motion[2], motion[3] if self.l > 1 else None
        z = heard - total_weight * motion[0]
        return z, (z - motion[2]) / self.filter_s

    def rate(self, y, heard, total_weight):
        """`heard` is sum_j w_ij (what i hears of j, gains applied), (n, m);
        `total_weight` is sum_j w_ij, (n, 1)."""
        motion, theta_hat, _ = self.unpack(y)
        l = self.l
        q, dq = motion[:2]
        z, dz = self.asked(y, heard, total_weight)

        def highest(own):
            """The top of the reference, from x_0 .. x_l."""
            return (heard - (self.alpha[:l] * own[1:]).sum(axis=0)
                    - total_weight * (self.alpha * own).sum(axis=0)
                    + self.manipulability * (dq - z))

        if self.kind == "consensus":
            top = highest(np.concatenate([motion[:2], motion[3:]]))  # q, dq, z', .., z^(l-1)
            dz = top if l == 1 else dz
        s = dq - z
        Ks = np.einsum("nab,nb->na", self.K, s)
        Y = self.regressor(q, dq, z, dz)
        tau = np.einsum("nap,np->na", Y, theta_hat) - Ks
        dtheta_hat = -np.einsum("npr,nar,na->np", self.Gamma, Y, s) if self.Gamma.any() \
            else np.zeros((self.n, self.p))
        ddq = self.acceleration(q, dq, tau)
        if self.kind == "pure_integral":
            top = highest(np.stack([q, dq, ddq]))
        elif self.kind == "backstepping":
            top = dz  # of the filter: (z - f) / epsilon

        dy = np.empty_like(y)
        dmotion = dy[: self.motion_size].reshape(2 + l, self.n, self.m)
        dmotion[0] = dq
        dmotion[1] = ddq
        dmotion[2:-1] = motion[3:]
        dmotion[-1] = top
        dy[self.motion_size : self.theta_end] = dtheta_hat.ravel()
        dy[self.theta_end :] = (s * Ks).sum(axis=1)
        return dy

    def regressor(self, q, dq, z, dz):
        """Y of M(q) dz + C(q, dq) z + g(q) = Y theta."""
        Y = np.zeros((self.n, self.m, self.p))
        Y[self.masses, :, 0] = dz[self.masses]
        if self.arms.size:
            a = self.arms
            q1, q2 = q[a].T
            v1, v2 = dq[a].T
            z1, z2 = z[a].T
            w1, w2 = dz[a].T
            c2, s2, c1, c12 = np.cos(q2), np.sin(q2), np.cos(q1), np.cos(q1 + q2)
            zero = np.zeros_like(c2)
            rows = [
                [w1, w2, c2 * (2 * w1 + w2) - s2 * (v2 * z1 + (v1 + v2) * z2), c1, c12],
                [zero, w1 + w2, c2 * w1 + s2 * v1 * z1, zero, c12],
            ]
            Y[a] = np.array(rows).transpose(2, 0, 1)
        return Y

    def inertia(self, q):
        M = np.zeros((self.n, self.m, self.m))
        M[self.masses] = self.theta[self.masses, 0, None, None] * np.eye(self.m)
        if self.arms.size:
            th1, th2, th3 = self.theta[self.arms, :3].T
            c2 = np.cos(q[self.arms, 1])
            M[self.arms] = np.array(
                [[th1 + 2 * th3 * c2, th2 + th3 * c2], [th2 + th3 * c2, th2]]
            ).transpose(2, 0, 1)
        return M

    def acceleration(self, q, dq, tau):
        ddq = np.empty_like(dq)
        ddq[self.masses] = tau[self.masses] * self.inverse_mass[:, None]
        if self.arms.size:
            a = self.arms
            th1, th2, th3, th4, th5 = self.theta[a].T
            q1, q2 = q[a].T
            v1, v2 = dq[a].T
            c2, s2 = np.cos(q2), np.sin(q2)
            g2 = th5 * np.cos(q1 + q2)
            m11, m12, m22 = th1 + 2 * th3 * c2, th2 + th3 * c2, th2
            f1 = tau[a, 0] + th3 * s2 * (2 * v1 + v2) * v2 - th4 * np.cos(q1) - g2
            f2 = tau[a, 1] - th3 * s2 * v1 * v1 - g2
            determinant = m11 * m22 - m12 * m12
            ddq[a, 0] = (m22 * f1 - m12 * f2) / determinant
            ddq[a, 1] = (m11 * f2 - m12 * f1) / determinant
        return ddq

    def storage(self, y, z):
        """V = 1/2 s^T M s + 1/2 (theta_hat - theta)^T Gamma^-1 (theta_hat - theta)."""
        motion, theta_hat, _ = self.unpack(y)
        s = motion[1] - z
        error = theta_hat - self.theta
        return (np.einsum("na,nab,nb->n", s, self.inertia(motion[0]), s)
                + np.einsum("np,npr,nr->n", error, self.Gamma_inverse, error)) / 2
