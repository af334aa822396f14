// Times Manifold's Boolean (the npm package manifold-3d, in WebAssembly, on one thread), by the program's own processor time:
// one plane through the ball of `nendo bench cut`, both halves, and the union of the balls of `nendo bench join`.
//   npm install manifold-3d && node tests/evidence/manifold_boolean.mjs    from where the package was installed
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

const { default: Module } = await import(pathToFileURL(resolve("node_modules/manifold-3d/manifold.js")).href);
const manifold = await Module();
manifold.setup();
const { Manifold, Mesh } = manifold; // setup() makes the classes

const point = [0.1, 0.05, 0.02];
const normal = [0.3, 0.5, 0.8].map((x) => x / Math.hypot(0.3, 0.5, 0.8));
const offset = point[0] * normal[0] + point[1] * normal[1] + point[2] * normal[2];

function ball(rings, middle = 0, isBumpy = true) {
  const segments = 2 * rings;
  const places = [middle, 0, 1, middle, 0, -1];
  for (let ring = 0; ring < rings; ++ring)
    for (let segment = 0; segment < segments; ++segment) {
      const polar = (Math.PI * (ring + 1)) / (rings + 1);
      const turn = (2 * Math.PI * segment) / segments;
      const [x, y, z] = [Math.sin(polar) * Math.cos(turn), Math.sin(polar) * Math.sin(turn), Math.cos(polar)];
      const bump = isBumpy ? 1 + 0.1 * Math.sin(7 * x) * Math.sin(9 * y + 1) : 1;
      places.push(middle + x * bump, y * bump, z * bump);
    }
  const faces = [];
  const last = 2 + (rings - 1) * segments;
  for (let at = 0; at < segments; ++at) {
    const beside = (at + 1) % segments;
    faces.push(0, 2 + at, 2 + beside);
    for (let start = 2; start < last; start += segments)
      faces.push(start + at, start + segments + at, start + segments + beside,
                 start + at, start + segments + beside, start + beside);
    faces.push(last + at, 1, last + beside);
  }
  return new Manifold(new Mesh({ numProp: 3, vertProperties: Float32Array.from(places), triVerts: Uint32Array.from(faces) }));
}

function timed(work) { // results are made when somebody asks for them
  const begin = process.cpuUsage();
  const volumes = work().map((made) => made.volume());
  const { user, system } = process.cpuUsage(begin);
  return { ms: (user + system) / 1000, volumes };
}
const best = (count, work) => Array.from({ length: count }, () => timed(work)).reduce((a, b) => (b.ms < a.ms ? b : a));

for (const rings of [87, 287]) {
  const thing = ball(rings);
  const whole = thing.volume();
  const run = best(5, () => thing.splitByPlane(normal, offset));
  const [above, below] = run.volumes;
  console.log(`${thing.numTri()} triangles: both halves ${run.ms.toFixed(0)} ms, ` +
              `volumes ${above.toFixed(9)} + ${below.toFixed(9)} = ${(above + below).toFixed(9)}, before ${whole.toFixed(9)}`);
}
for (const rings of [40, 87, 160]) {
  const [one, other] = [ball(rings, 0, false), ball(rings, 1, false)];
  one.volume(), other.volume();
  const run = best(5, () => [one.add(other)]);
  const exact = (8 / 3 - 5 / 12) * Math.PI;
  console.log(`2 x ${one.numTri()} triangles: union ${run.ms.toFixed(0)} ms, volume off by ${Math.abs(run.volumes[0] / exact - 1).toExponential(1)}`);
}
