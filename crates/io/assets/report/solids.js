// Bodies with light and depth, where the browser has WebGL: one drawn cylinder and one sphere, as often as needed.

// Whether the browser has WebGL without a graphics card, as far as it says.
const drawsInSoftware = () => {
  const context = element("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  if (context === null) return true;
  let name = String(context.getParameter(context.RENDERER));
  // Some name the driver only when asked in this way.
  const info = name === "WebKit WebGL" ? context.getExtension("WEBGL_debug_renderer_info") : null;
  if (info) name = String(context.getParameter(info.UNMASKED_RENDERER_WEBGL));
  context.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
};

const lighting = (() => {
  const canvas = element("canvas");
  if (charted || typeof THREE === "undefined" || new URLSearchParams(location.search).has("flat")) return null;
  // Asked for here, where a browser without it says nothing. Without a graphics card edges are left as they are, and shapes are coarser.
  const inSoftware = drawsInSoftware();
  const context = canvas.getContext("webgl2", { alpha: true, antialias: !inSoftware });
  if (context === null) return null;
  let renderer;
  try {
    renderer = new THREE.WebGLRenderer({ canvas, context, alpha: true });
  } catch {
    return null; // The picture is projected instead.
  }
  const world3 = new THREE.Scene();
  const sun = new THREE.DirectionalLight(0xffffff, 2.1);
  world3.add(new THREE.HemisphereLight(0xffffff, 0x8a8f99, 1.5), sun);
  const eye = new THREE.PerspectiveCamera((FIELD * 180) / Math.PI, 1, 0.1, 1000);
  const [sides, rings] = inSoftware ? [10, 6] : [16, 10];
  const round = { cylinder: new THREE.CylinderGeometry(1, 1, 1, sides, 1, true), sphere: new THREE.SphereGeometry(1, sides, rings) };
  const material = new THREE.MeshLambertMaterial({ color: 0xffffff });
  const floor = new THREE.BufferGeometry();
  floor.setAttribute("position", new THREE.BufferAttribute(new Float32Array(floorGrid.lines.flat(2)), 3));
  const pencil = new THREE.LineBasicMaterial({ color: 0xcccccc });
  if (!inSoftware) world3.add(new THREE.LineSegments(floor, pencil));
  // Thin lines would be interrupted there, so the floor is drawn by hand underneath.
  const ground = inSoftware ? element("canvas") : null;
  const layers = element("div", {}, ...(ground ? [ground] : []), canvas);
  let grounded = "";
  const drawGround = (see, colours) => {
    const scale = Math.min(2, devicePixelRatio || 1);
    const asBefore = [see.width, see.height, scale, colours.grid, ...see.eye, ...see.back].join();
    if (grounded === asBefore) return;
    grounded = asBefore;
    Object.assign(ground, { width: Math.round(see.width * scale), height: Math.round(see.height * scale) });
    const pen = ground.getContext("2d");
    pen.setTransform(scale, 0, 0, scale, 0, 0);
    drawUnder(pen, see, colours);
  };
  let meshes = null;
  const room = (count) => {
    if (meshes && meshes.size >= count) return meshes;
    if (meshes) world3.remove(meshes.tubes, meshes.balls);
    const size = Math.max(64, 2 * count);
    const tubes = new THREE.InstancedMesh(round.cylinder, material, size);
    const balls = new THREE.InstancedMesh(round.sphere, material, 2 * size);
    tubes.frustumCulled = balls.frustumCulled = false;
    world3.add(tubes, balls);
    meshes = { tubes, balls, size };
    return meshes;
  };
  // A shape as often as robots have it, with flat faces that are seen from both sides, which is 2.
  const plain = new THREE.MeshLambertMaterial({ color: 0xffffff, side: 2, flatShading: true });
  const words = (text) => new Uint16Array(Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer);
  const shapes = scene.solids.map(({ low, step, points, faces }, k) => {
    const shape = new THREE.BufferGeometry();
    shape.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(words(points), (n, i) => low[i % 3] + step[i % 3] * n), 3));
    shape.setIndex(new THREE.BufferAttribute(words(faces), 1));
    const most = bodies.filter((body) => body.kind === "arm").reduce((count, body) => count + scene.arms[body.arm].parts.filter((part) => part.solid === k).length, 0);
    const mesh = new THREE.InstancedMesh(shape, plain, Math.max(1, most));
    mesh.frustumCulled = false;
    world3.add(mesh);
    return { mesh, most };
  });
  const matrix = new THREE.Matrix4();
  const paints = new Map();
  const paint = (text, faint) => {
    const name = `${text}${faint}`;
    if (!paints.has(name)) paints.set(name, new THREE.Color(text).lerp(new THREE.Color(0x999999), faint ? 0.45 : 0));
    return paints.get(name);
  };
  // Pixels of what moves for each of the page, which a slow browser is given fewer of.
  let share = 1;
  const coarser = () => {
    if (share <= 0.5) return false;
    share -= 0.25;
    return true;
  };
  // In software what stands still is drawn with more pixels than the screen has, which smooths its edges.
  const density = (still) => {
    const usual = Math.min(2, devicePixelRatio || 1);
    if (still) return inSoftware ? 2 : usual;
    return share * (inSoftware ? Math.min(1, usual) : usual);
  };
  // The ball at the beginning of a link is hidden in that at the end of the one before, if that is as thick.
  const covered = (solid, before) => before !== undefined && before.colour === solid.colour && before.r >= solid.r && before.b.every((x, i) => x === solid.a[i]);
  const draw = (see, frame, colours, still = false) => {
    const scale = density(still);
    if (renderer.getPixelRatio() !== scale) renderer.setPixelRatio(scale);
    renderer.setSize(see.width, see.height, false);
    eye.aspect = see.width / see.height;
    eye.near = 0.01 * see.distance;
    eye.far = 20 * (see.distance + world.extent);
    eye.up.set(...see.upward);
    eye.position.set(...see.eye);
    eye.lookAt(...see.middle);
    eye.updateProjectionMatrix();
    sun.position.set(...add(add(see.back, scaled(see.upward, 0.8)), scaled(see.right, -0.6)));
    pencil.color.set(colours.grid);
    if (ground) drawGround(see, colours);
    const capsules = frame.solids.filter((solid) => !solid.shaped);
    const { tubes, balls } = room(capsules.length);
    let ends = 0;
    capsules.forEach((solid, k) => {
      const { a, b, r, faint } = solid;
      const along = minusVector(b, a);
      const length = size(along);
      const y = length > 0 ? scaled(along, 1 / length) : [0, 0, 1];
      const x = unitVector(cross(y, Math.abs(y[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0]));
      const z = cross(x, y);
      const m = scaled(add(a, b), 0.5);
      matrix.set(r * x[0], length * y[0], r * z[0], m[0], r * x[1], length * y[1], r * z[1], m[1], r * x[2], length * y[2], r * z[2], m[2], 0, 0, 0, 1);
      tubes.setMatrixAt(k, matrix);
      const tint = paint(inkOf(colours, solid), faint);
      tubes.setColorAt(k, tint);
      for (const p of covered(solid, capsules[k - 1]) ? [b] : [a, b]) {
        matrix.set(r, 0, 0, p[0], 0, r, 0, p[1], 0, 0, r, p[2], 0, 0, 0, 1);
        balls.setMatrixAt(ends, matrix);
        balls.setColorAt(ends, tint);
        ends += 1;
      }
    });
    tubes.count = capsules.length;
    balls.count = ends;
    shapes.forEach((shape, k) => {
      const own = frame.parts.filter((part) => part.solid === k).slice(0, shape.most);
      own.forEach(({ turn: [x, y, z], at, faint, ...item }, n) => {
        matrix.set(...x, at[0], ...y, at[1], ...z, at[2], 0, 0, 0, 1);
        shape.mesh.setMatrixAt(n, matrix);
        shape.mesh.setColorAt(n, paint(inkOf(colours, item), faint));
      });
      shape.mesh.count = own.length;
    });
    for (const mesh of [tubes, balls, ...shapes.map((shape) => shape.mesh)]) {
      mesh.instanceMatrix.needsUpdate = true;
      if (mesh.instanceColor) mesh.instanceColor.needsUpdate = true;
    }
    renderer.render(world3, eye);
  };
  return { canvas, layers, draw, coarser, inSoftware };
})();
