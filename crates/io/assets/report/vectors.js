// Vectors, turns and the kinematics of arms.

const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const minusVector = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const scaled = (a, k) => [k * a[0], k * a[1], k * a[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const size = (a) => Math.sqrt(dot(a, a));
const unitVector = (a) => scaled(a, 1 / (size(a) || 1));
const finite = (a) => a.every(Number.isFinite);
const ORIGIN = [0, 0, 0];

// A frame in another: the rows of its turn, and where its origin is.
const IDENTITY = { turn: [[1, 0, 0], [0, 1, 0], [0, 0, 1]], at: ORIGIN };
const turned = (turn, v) => [dot(turn[0], v), dot(turn[1], v), dot(turn[2], v)];
const pointOf = (frame, p) => add(turned(frame.turn, p), frame.at);
const composed = (a, b) => {
  const columns = [0, 1, 2].map((k) => turned(a.turn, b.turn.map((row) => row[k])));
  return { turn: [0, 1, 2].map((row) => columns.map((column) => column[row])), at: pointOf(a, b.at) };
};

// What a joint does: a turn about its axis, by Rodrigues, or a shift along it.
const jointFrame = ({ turns, axis: [x, y, z] }, value) => {
  if (!turns) return { turn: IDENTITY.turn, at: [x * value, y * value, z * value] };
  const [s, c] = [Math.sin(value), Math.cos(value)];
  const v = 1 - c;
  return {
    turn: [
      [c + v * x * x, v * x * y - s * z, v * x * z + s * y],
      [v * x * y + s * z, c + v * y * y, v * y * z - s * x],
      [v * x * z - s * y, v * y * z + s * x, c + v * z * z],
    ],
    at: ORIGIN,
  };
};

// The frames of all joints of an arm: T_k = T_parent · P_k · J(q_k).
const armFrames = (arm, q) => {
  const frames = [];
  arm.joints.forEach((joint, k) => {
    const before = joint.parent === null ? IDENTITY : frames[joint.parent];
    const place = composed(before, { turn: joint.place[0], at: joint.place[1] });
    frames.push({ ...composed(place, jointFrame(joint, q[k])), place: place.at, before: before.at });
  });
  return frames;
};
const armTip = (arm, frames) => (arm.tip ? pointOf(frames[arm.tip[0]], arm.tip[1]) : (frames.at(-1)?.at ?? ORIGIN));

// The turn of a quaternion with its scalar last; of any length but zero.
const quaternionTurn = (q) => {
  const length = Math.hypot(...q) || 1;
  const [x, y, z, o] = q.map((entry) => entry / length);
  return [
    [1 - 2 * (y * y + z * z), 2 * (x * y - o * z), 2 * (x * z + o * y)],
    [2 * (x * y + o * z), 1 - 2 * (x * x + z * z), 2 * (y * z - o * x)],
    [2 * (x * z - o * y), 2 * (y * z + o * x), 1 - 2 * (x * x + y * y)],
  ];
};

// The least and the greatest coordinates of points.
const boxOf = (points) => {
  const box = { low: [Infinity, Infinity, Infinity], high: [-Infinity, -Infinity, -Infinity] };
  for (const p of points) {
    if (!finite(p)) continue;
    for (let k = 0; k < 3; k++) {
      box.low[k] = Math.min(box.low[k], p[k]);
      box.high[k] = Math.max(box.high[k], p[k]);
    }
  }
  return Number.isFinite(box.low[0]) ? box : { low: [-1, -1, -1], high: [1, 1, 1] };
};
