"""The problems."""

from problem import (PURE_INTEGRAL, agent, backstepping, constant, edge, fixed, once,
                     piecewise_constant, planar_arm, point_mass, problem, repeat, saw_tooth,
                     sinusoid)

POSITION, BOTH = "position", "position_velocity"


def kappa(order):
    return [1.0, 2.0, 3.0, 4.0][:order]


ARMS = [
    planar_arm((1.0, 1.0), (1.0, 1.0)),
    planar_arm((0.8, 1.1), (1.5, 0.9)),
    planar_arm((1.2, 0.7), (0.8, 1.3)),
    planar_arm((0.9, 0.9), (1.1, 0.7), centres=(0.4, 0.5), inertias=(0.09, 0.06)),
    planar_arm((1.0, 0.8), (2.0, 1.0)),
]
ARM_STARTS = [(0.6, -0.3), (-0.4, 0.8), (1.1, 0.2), (-0.9, -0.5), (0.2, 1.3)]


def arms(count, order, **options):
    return [agent(ARMS[i], kappa(order), q=ARM_STARTS[i], **options) for i in range(count)]


def ring(count, delay, weight=1.0):
    """Agent i hears agent i - 1; one delay for all, or one for each receiver."""
    delays = delay if isinstance(delay, list) else [delay] * count
    return [edge((i - 1) % count, i, weight, delays[i]) for i in range(count)]


def fixed_graphs():
    yield problem(
        "01-order1-both-constant", "Four arms, ring, one constant delay.",
        12.0, BOTH, arms(4, 1), fixed(ring(4, constant(0.3))))

    yield problem(
        "02-order1-position-sinusoid", "Three arms, ring, sinusoidal delays.",
        12.0, POSITION, arms(3, 1), fixed(ring(3, [
            sinusoid(0.3, 0.2, 2.0), sinusoid(0.2, 0.1, 3.0, 1.0),
            sinusoid(0.4, 0.15, 5.0, -2.0)])))

    yield problem(
        "03-order2-both-zero-delay", "Three arms; no delay, edges both ways along a path.",
        12.0, BOTH, arms(3, 2), fixed([
            edge(0, 1, 1.0, constant(0.0)), edge(1, 0, 1.0, constant(0.0)),
            edge(1, 2, 0.5, constant(0.0)), edge(2, 1, 0.5, constant(0.0))]))

    yield problem(
        "04-order2-position-saw-tooth", "Four arms, ring, saw-tooth and constant delays.",
        12.0, POSITION, arms(4, 2), fixed(ring(4, [
            saw_tooth(0.1, 0.4, 1.0), saw_tooth(0.05, 0.35, 0.7, 0.2),
            saw_tooth(0.2, 0.3, 2.5, 1.1), constant(0.25)])))

    yield problem(
        "05-order3-both-constant", "Four arms, ring and one chord, distinct constant delays.",
        15.0, BOTH, arms(4, 3),
        fixed(ring(4, [constant(0.15), constant(0.4), constant(0.27), constant(0.33)])
              + [edge(2, 0, 0.7, constant(0.61))]))

    yield problem(
        "06-order4-both-constant", "Three arms of order four, ring.",
        15.0, BOTH, arms(3, 4), fixed(ring(3, [constant(0.2), constant(0.35), constant(0.5)])))

    yield problem(
        "07-order4-position-sinusoid", "Four arms of order four, ring, sinusoidal delays.",
        15.0, POSITION, arms(4, 4), fixed(ring(4, [
            sinusoid(0.3, 0.1, 4.0), sinusoid(0.25, 0.2, 1.5, 0.5),
            sinusoid(0.5, 0.3, 6.0, 2.0), sinusoid(0.2, 0.05, 0.8)])))

    yield problem(
        "08-short-delay", "Three arms; a delay of 1 ms, shorter than any step one would choose.",
        10.0, BOTH, arms(3, 1), fixed(ring(3, [constant(0.001), constant(0.2), constant(0.001)])))

    yield problem(
        "09-delay-beyond-the-end", "Three arms; one edge only ever hears the initial value.",
        12.0, POSITION, arms(3, 2), fixed(ring(3, [constant(0.3), constant(30.0), constant(0.2)])))

    yield problem(
        "10-mixed-delays", "Five arms; all kinds of delay and different weights at once.",
        12.0, POSITION, arms(5, 2), fixed([
            edge(0, 1, 1.3, constant(0.22)),
            edge(1, 2, 0.4, sinusoid(0.3, 0.2, 2.0, 0.3)),
            edge(2, 3, 0.9, piecewise_constant([0.0, 0.9, 2.0], [0.1, 0.45, 0.25], 3.1)),
            edge(3, 4, 1.1, saw_tooth(0.1, 0.5, 1.3, 0.4)),
            edge(4, 0, 0.6, constant(0.0)),
            edge(2, 0, 0.25, piecewise_constant([0.0, 4.0], [0.6, 0.05]))]))

    yield problem(
        "11-sampled-links", "Three arms heard through a sample-and-hold: the delay grows as fast "
        "as time, from exactly zero on one edge, and faster than time on another.",
        10.0, BOTH, arms(3, 1), fixed(ring(3, [
            saw_tooth(0.0, 0.5, 0.5), saw_tooth(0.1, 0.35, 0.25, 0.1),
            saw_tooth(0.05, 0.65, 0.4)])))

    yield problem(
        "12-backward-hearing", "Three arms; sinusoidal delays that change so fast that what is "
        "heard at times runs backwards.",
        10.0, POSITION, arms(3, 2), fixed(ring(3, [
            sinusoid(0.4, 0.3, 1.0), sinusoid(0.35, 0.3, 1.5, 1.0), constant(0.15)])))

    # With known parameters and z(0) = dq(0), s would stay zero.
    yield problem(
        "13-known-parameters", "Three arms that know their parameters; z(0) differs from dq(0).",
        12.0, BOTH, [
            agent(ARMS[i], kappa(2), knows_theta=True, q=ARM_STARTS[i],
                  reference=[[0.5, -0.4 * i], [0.0, 0.3]]) for i in range(3)],
        fixed(ring(3, [
            sinusoid(0.3, 0.1, 2.0), constant(0.2), sinusoid(0.25, 0.2, 3.0, 1.5)])))


def switching_graphs():
    yield problem(
        "14-order1-both-switching", "Four arms; two halves of a ring take turns.",
        12.0, BOTH, arms(4, 1), repeat(
            (0.7, [edge(0, 1, 1.0, constant(0.2)), edge(2, 3, 1.0, constant(0.3))]),
            (0.9, [edge(1, 2, 1.0, constant(0.2)), edge(3, 0, 1.0, constant(0.3))])))

    yield problem(
        "15-order2-both-switching", "Four arms; one edge at a time, and a phase with none.",
        14.0, BOTH, arms(4, 2), repeat(
            (0.5, [edge(0, 1, 2.0, constant(0.25))]),
            (0.6, [edge(1, 2, 1.5, constant(0.4))]),
            (0.4, []),
            (0.7, [edge(2, 3, 1.0, constant(0.1))]),
            (0.8, [edge(3, 0, 1.5, constant(0.25))])))

    yield problem(
        "16-order3-position-switching", "Four arms; jumping delays under a switching graph.",
        14.0, POSITION, arms(4, 3), repeat(
            (1.1, ring(4, piecewise_constant([0.0, 0.8], [0.2, 0.5], 1.7))),
            (0.6, [edge(0, 2, 1.0, sinusoid(0.3, 0.1, 2.0)), edge(2, 0, 2.0, constant(0.15))])))

    yield problem(
        "17-order3-both-once", "Three arms; three graphs in turn, the last one stays.",
        14.0, BOTH, arms(3, 3), once(
            (2.0, [edge(0, 1, 1.0, constant(0.3))]),
            (3.5, [edge(1, 2, 1.0, piecewise_constant([0.0, 3.0, 4.1], [0.1, 0.45, 0.2]))]),
            (1.0, ring(3, [constant(0.2), constant(0.3), saw_tooth(0.1, 0.3, 1.6)]))))

    yield problem(
        "18-order4-position-switching", "Three arms of order four; a ring turned round and round.",
        15.0, POSITION, arms(3, 4), repeat(
            (1.3, ring(3, constant(0.3))),
            (1.2, [edge((i + 1) % 3, i, 1.0, constant(0.2)) for i in range(3)])))

    yield problem(
        "19-order4-both-switching", "Four arms of order four; weights switch, delays jump.",
        15.0, BOTH, arms(4, 4), repeat(
            (1.5, ring(4, piecewise_constant([0.0, 1.1], [0.15, 0.4], 2.3), 0.5)),
            (1.0, ring(4, piecewise_constant([0.0, 1.1], [0.15, 0.4], 2.3), 2.0))))


def other_robots():
    starts = [0.9, -1.3, 0.4, 2.0, -0.6]
    yield problem(
        "20-point-masses-line", "Five adaptive point masses on a line, switching graph.",
        15.0, POSITION,
        [agent(point_mass(1, 0.5 + 0.4 * i), kappa(1), q=[starts[i]]) for i in range(5)],
        repeat((0.8, ring(5, constant(0.3))[:3]), (0.7, ring(5, saw_tooth(0.1, 0.4, 0.9))[2:])))

    yield problem(
        "21-point-masses-space", "Four point masses in space that know their mass, with dq(0) "
        "and z(0) apart.",
        15.0, BOTH,
        [agent(point_mass(3, 1.0 + 0.5 * i), kappa(3), knows_theta=True, K=6.0 + i,
               q=[starts[i], starts[(i + 1) % 5], starts[(i + 3) % 5]], dq=[0.3, -0.2, 0.1 * i],
               reference=[[0.0, 0.4, -0.3], [0.2, 0.0, 0.0], [0.0, 0.0, 0.0]])
         for i in range(4)],
        fixed(ring(4, [sinusoid(0.4, 0.2, 3.0), constant(0.3), sinusoid(0.2, 0.1, 1.0, 1.0),
                       constant(0.5)])))

    yield problem(
        "22-arms-and-masses", "Two arms and two point masses in the plane, in one network; one of "
        "each kind knows its parameters.",
        14.0, BOTH, [
            agent(ARMS[0], kappa(2), q=[0.6, -0.3]),
            agent(point_mass(2, 1.7), kappa(2), q=[-0.8, 0.5]),
            agent(ARMS[3], kappa(2), q=[-0.9, -0.5], knows_theta=True),
            agent(point_mass(2, 0.6), kappa(2), q=[1.2, 0.1], knows_theta=True)],
        repeat((1.0, ring(4, constant(0.25))),
               (0.5, [edge(3, 0, 1.0, saw_tooth(0.1, 0.3, 0.8)), edge(0, 2, 2.0, constant(0.0))])))


def own_settings():
    yield problem(
        "23-own-roots-and-gains", "Each agent with roots and gains of its own; K and Gamma as a "
        "number, a diagonal and a full matrix.",
        12.0, POSITION, [
            agent(ARMS[0], [1.0, 2.0, 3.0], K=8.0, Gamma=10.0, q=ARM_STARTS[0]),
            agent(ARMS[1], [2.0, 1.5, 4.0], K=[9.0, 6.0], Gamma=[10.0, 8.0, 12.0, 10.0, 9.0],
                  q=ARM_STARTS[1]),
            agent(ARMS[2], [0.8, 0.8, 2.5], K=[[9.0, 1.0], [1.0, 7.0]],
                  Gamma=[[10.0, 1.0, 0.0, 0.0, 0.5], [1.0, 9.0, 0.5, 0.0, 0.0],
                         [0.0, 0.5, 11.0, 1.0, 0.0], [0.0, 0.0, 1.0, 10.0, 1.5],
                         [0.5, 0.0, 0.0, 1.5, 8.0]], q=ARM_STARTS[2])],
        repeat((0.9, ring(3, constant(0.3))), (0.6, ring(3, constant(0.2))[1:])))

    # With velocities exchanged the first root must be common.
    yield problem(
        "24-own-roots-both", "Roots of their own but for the first, velocities exchanged.",
        12.0, BOTH, [
            agent(ARMS[0], [1.2, 2.0], q=ARM_STARTS[0]),
            agent(ARMS[1], [1.2, 3.0], q=ARM_STARTS[1], K=[7.0, 9.0]),
            agent(point_mass(2, 2.0), [1.2, 1.5], q=[0.3, -0.7], Gamma=[5.0])],
        fixed(ring(3, [sinusoid(0.3, 0.2, 2.0), piecewise_constant([0.0, 0.7], [0.3, 0.1], 1.9),
                       constant(0.4)])))

    yield problem(
        "25-start-in-motion", "Arms that start in motion, with references and estimates that "
        "start elsewhere.",
        12.0, BOTH, [
            agent(ARMS[0], kappa(3), q=[0.6, -0.3], dq=[0.5, -0.8]),
            agent(ARMS[1], kappa(3), q=[-0.4, 0.8], dq=[-0.3, 0.2],
                  reference=[[0.4, -0.1], [0.2, 0.3], [-0.5, 0.1]]),
            agent(ARMS[2], kappa(3), q=[1.1, 0.2], dq=[0.0, 0.6],
                  reference=[[0.0, 0.0], [-0.3, 0.4], [0.6, -0.2]],
                  theta_hat=[1.0, 0.3, 0.4, 12.0, 5.0])],
        fixed(ring(3, [constant(0.3), sinusoid(0.25, 0.15, 2.0), constant(0.2)])))

    yield problem(
        "26-start-in-motion-order1", "As before with order one, and jumping delays.",
        12.0, BOTH, [
            agent(ARMS[0], kappa(1), q=[0.6, -0.3], dq=[0.5, -0.8], reference=[[0.1, 0.2]]),
            agent(ARMS[1], kappa(1), q=[-0.4, 0.8], dq=[-0.3, 0.2]),
            agent(ARMS[2], kappa(1), q=[1.1, 0.2], dq=[0.0, 0.6], reference=[[-0.5, 0.0]])],
        fixed(ring(3, piecewise_constant([0.0, 0.6, 1.0], [0.2, 0.5, 0.1], 1.6))))


def accelerations():
    """(3) and (23), with the acceleration of the robot in the reference."""
    yield problem(
        "27-pure-both-constant", "Four arms under (3), ring, distinct constant delays.",
        12.0, BOTH, arms(4, 2),
        fixed(ring(4, [constant(0.3), constant(0.2), constant(0.45), constant(0.1)])),
        PURE_INTEGRAL)

    yield problem(
        "28-pure-position-varying", "Three arms under (23), ring, sinusoidal and saw-tooth delays.",
        12.0, POSITION, arms(3, 2), fixed(ring(3, [
            sinusoid(0.3, 0.2, 2.0), saw_tooth(0.1, 0.4, 1.1, 0.3), constant(0.25)])),
        PURE_INTEGRAL)

    yield problem(
        "29-pure-both-jumping", "Arms under (3) that start in motion, with references of their own; "
        "delays jump, and one is zero.",
        12.0, BOTH, [
            agent(ARMS[0], [1.2, 0.7], q=[0.6, -0.3], dq=[0.5, -0.8],
                  reference=[[0.1, 0.2], [0.4, -0.6]]),
            agent(ARMS[1], [1.2, 0.7], q=[-0.4, 0.8], dq=[-0.3, 0.2], K=[7.0, 9.0]),
            agent(ARMS[2], [1.2, 0.7], q=[1.1, 0.2], dq=[0.0, 0.6],
                  reference=[[-0.5, 0.0], [0.0, 0.3]], theta_hat=[1.0, 0.3, 0.4, 12.0, 5.0])],
        fixed(ring(3, [piecewise_constant([0.0, 0.6, 1.0], [0.2, 0.5, 0.1], 1.6), constant(0.0),
                       piecewise_constant([0.0, 2.5], [0.6, 0.15])], 0.8)
              + [edge(0, 2, 0.5, sinusoid(0.25, 0.1, 3.0))]),
        PURE_INTEGRAL)

    yield problem(
        "30-pure-position-jumping", "An arm and two point masses in the plane under (23), jumping "
        "delays; the masses know theirs.",
        12.0, POSITION, [
            agent(ARMS[4], [0.9, 1.6], q=[0.2, 1.3]),
            agent(point_mass(2, 1.7), [0.9, 1.6], q=[-0.8, 0.5], dq=[0.4, 0.0], knows_theta=True),
            agent(point_mass(2, 0.6), [0.9, 1.6], q=[1.2, 0.1], knows_theta=True,
                  reference=[[0.3, -0.2], [0.0, 0.5]])],
        fixed(ring(3, piecewise_constant([0.0, 0.8], [0.15, 0.4], 1.7), 1.3)),
        PURE_INTEGRAL)


def manipulability():
    """Remark 4: lambda (dq - z) is added to the highest derivative."""
    def yielding(count, order, gains):
        return [agent(ARMS[i], kappa(order), q=ARM_STARTS[i], manipulability=gains[i])
                for i in range(count)]

    yield problem(
        "31-lambda-order1-both", "Four arms that give way, each in its own measure, one not at all; "
        "switching graph.",
        12.0, BOTH, yielding(4, 1, [0.8, 2.0, 0.0, 0.3]), repeat(
            (0.7, [edge(0, 1, 1.0, constant(0.2)), edge(2, 3, 1.0, constant(0.3))]),
            (0.9, [edge(1, 2, 1.0, constant(0.2)), edge(3, 0, 1.0, constant(0.3))])))

    yield problem(
        "32-lambda-order2-both", "Three arms that give way, jumping and saw-tooth delays.",
        12.0, BOTH, yielding(3, 2, [1.5, 0.5, 3.0]), fixed(ring(3, [
            piecewise_constant([0.0, 0.7], [0.3, 0.1], 1.9), saw_tooth(0.1, 0.4, 1.0),
            constant(0.2)])))

    yield problem(
        "33-lambda-order3-position", "Three arms that give way, of order three, switching graph.",
        12.0, POSITION, yielding(3, 3, [2.0, 1.0, 4.0]), repeat(
            (1.1, ring(3, constant(0.3))),
            (0.6, [edge(0, 2, 1.0, sinusoid(0.3, 0.1, 2.0)), edge(2, 1, 2.0, constant(0.15))])))

    yield problem(
        "34-lambda-pure-both", "Three arms under (3) that give way, which is (31); varying and "
        "jumping delays.",
        12.0, BOTH, yielding(3, 2, [1.5, 0.5, 3.0]), fixed(ring(3, [
            sinusoid(0.3, 0.2, 2.0), piecewise_constant([0.0, 0.7], [0.3, 0.1], 1.9),
            constant(0.2)])), PURE_INTEGRAL)

    yield problem(
        "35-lambda-pure-position", "Two arms under (23) that give way, jumping delays.",
        12.0, POSITION, yielding(2, 2, [2.0, 0.6]), fixed(ring(2, [
            piecewise_constant([0.0, 1.3], [0.1, 0.35], 2.1), constant(0.3)])), PURE_INTEGRAL)


def baseline():
    """(aa6) with a filter that differentiates."""
    yield problem(
        "36-backstepping-varying", "Three arms, ring, sinusoidal and constant delays.",
        10.0, POSITION, [agent(ARMS[i], [], q=ARM_STARTS[i]) for i in range(3)],
        fixed(ring(3, [sinusoid(0.3, 0.2, 2.0), constant(0.2), constant(0.0)])),
        backstepping(0.2))

    yield problem(
        "37-backstepping-switching", "Two arms and two point masses; the reference jumps with graph "
        "and delays.",
        10.0, POSITION, [
            agent(ARMS[0], [], q=[0.6, -0.3], dq=[0.3, -0.2]),
            agent(point_mass(2, 1.7), [], q=[-0.8, 0.5]),
            agent(ARMS[3], [], q=[-0.9, -0.5], knows_theta=True),
            agent(point_mass(2, 0.6), [], q=[1.2, 0.1], K=3.0, knows_theta=True)],
        repeat((1.1, ring(4, piecewise_constant([0.0, 0.8], [0.2, 0.5], 1.7))),
               (0.6, [edge(3, 0, 1.0, saw_tooth(0.1, 0.3, 0.8)), edge(0, 2, 2.0, constant(0.15))])),
        backstepping(0.1))


def all_cases():
    for group in (fixed_graphs, switching_graphs, other_robots, own_settings, accelerations,
                  manipulability, baseline):
        yield from group()
