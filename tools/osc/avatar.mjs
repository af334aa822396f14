// Moves two avatars by the bones that nendo sends, with three-vrm, which avatars in browsers are moved with: avatar.mjs
// NODE_MODULES MESSAGES. MESSAGES are those of hands that close, as receive.cjs prints them. In a T-pose palms look down: each
// bone of a finger must move that finger's tip towards the palm, and no other.
import fs from "fs";
import path from "path";

const [modules, messages] = process.argv.slice(2).map((part) => path.resolve(part));
const { GLTFLoader } = await import(`${modules}/three/examples/jsm/loaders/GLTFLoader.js`);
const THREE = await import(`${modules}/three/build/three.module.js`);
const { VRMLoaderPlugin } = await import(`${modules}/@pixiv/three-vrm/lib/three-vrm.module.js`);

const fingers = ["Thumb", "Index", "Middle", "Ring", "Little"];
const phalanges = ["Proximal", "Intermediate", "Distal"];
// VRM 0 looks along -z, VRM 1 along z; Unity's importers mirror z of the one, and x of the other.
const versions = [
  { name: "VRM 0", ahead: -1, turned: ([x, y, z, w]) => [-x, -y, z, w] },
  { name: "VRM 1", ahead: 1, turned: ([x, y, z, w]) => [x, -y, -z, w] },
];

// The rotation of each bone that turns most.
function mostTurned(lines) {
  const most = new Map();
  for (const line of lines) {
    const [address, , values] = JSON.parse(line);
    if (address !== "/VMC/Ext/Bone/Pos") continue;
    const [bone, , , , ...turn] = values;
    if (!most.has(bone) || Math.abs(turn[3]) < Math.abs(most.get(bone)[3])) most.set(bone, turn);
  }
  return most;
}

// A glTF of bones alone. `places` are where they are, in metres.
function avatar({ name, ahead }) {
  const nodes = [], bones = {}, places = [];
  const add = (bone, parent, place) => {
    const from = parent === null ? [0, 0, 0] : places[parent];
    nodes.push({ name: bone, translation: place.map((number, axis) => number - from[axis]), children: [] });
    places.push(place);
    if (parent !== null) nodes[parent].children.push(nodes.length - 1);
    if (!bone.endsWith("Tip")) bones[bone] = nodes.length - 1;
    return nodes.length - 1;
  };
  const hips = add("hips", null, [0, 1, 0]), spine = add("spine", hips, [0, 1.1, 0]), chest = add("chest", spine, [0, 1.3, 0]);
  add("head", add("neck", chest, [0, 1.5, 0]), [0, 1.6, 0]);
  for (const side of ["left", "right"]) {
    const out = (side === "right" ? -1 : 1) * ahead; // its way along x
    const leg = add(`${side}UpperLeg`, hips, [0.1 * out, 0.9, 0]);
    add(`${side}Foot`, add(`${side}LowerLeg`, leg, [0.1 * out, 0.5, 0]), [0.1 * out, 0.1, 0]);
    const arm = add(`${side}UpperArm`, chest, [0.15 * out, 1.4, 0]);
    const hand = add(`${side}Hand`, add(`${side}LowerArm`, arm, [0.4 * out, 1.4, 0]), [0.65 * out, 1.4, 0]);
    fingers.forEach((finger, at) => {
      const isThumb = at === 0, along = isThumb ? [0.87 * out, 0, 0.5 * ahead] : [out, 0, 0];
      let place = isThumb ? [0.68 * out, 1.39, 0.03 * ahead] : [0.74 * out, 1.4, (0.05 - 0.02 * at) * ahead], parent = hand;
      const names = isThumb && name === "VRM 1" ? ["Metacarpal", "Proximal", "Distal"] : phalanges;
      for (const phalanx of [...names, "Tip"]) {
        parent = add(`${side}${finger}${phalanx}`, parent, place);
        place = place.map((number, axis) => number + 0.03 * along[axis]);
      }
    });
  }
  for (const node of nodes) if (node.children.length === 0) delete node.children;
  const one = name === "VRM 1";
  const human = one ? Object.fromEntries(Object.entries(bones).map(([bone, node]) => [bone, { node }]))
    : Object.entries(bones).map(([bone, node]) => ({ bone, node, useDefaultValues: true }));
  const meta = one ? { name: "bones", authors: ["test"], licenseUrl: "https://vrm.dev/licenses/1.0/" } : { title: "bones" };
  const extension = one ? { specVersion: "1.0", meta, humanoid: { humanBones: human } } : { specVersion: "0.0", meta, humanoid: { humanBones: human } };
  const key = one ? "VRMC_vrm" : "VRM";
  return JSON.stringify({ asset: { version: "2.0" }, scene: 0, scenes: [{ nodes: [hips] }], nodes, extensionsUsed: [key], extensions: { [key]: extension } });
}

async function load(version) {
  const loader = new GLTFLoader();
  loader.register((parser) => new VRMLoaderPlugin(parser));
  const gltf = await loader.parseAsync(avatar(version), "");
  return gltf.userData.vrm;
}

// three-vrm has the names of VRM 1.
function threeName(bone) {
  const name = bone[0].toLowerCase() + bone.slice(1);
  return name.replace("ThumbProximal", "ThumbMetacarpal").replace("ThumbIntermediate", "ThumbProximal");
}

function tips(vrm, side) {
  vrm.humanoid.update();
  vrm.scene.updateMatrixWorld(true);
  return fingers.map((finger) => vrm.scene.getObjectByName(`${side}${finger}Tip`).getWorldPosition(new THREE.Vector3()));
}

const turns = mostTurned(fs.readFileSync(messages, "utf8").trim().split("\n"));
let faults = 0, checked = 0;
const fault = (words) => { console.error(`avatar.mjs: ${words}`); faults += 1; };
for (const version of versions) {
  const vrm = await load(version);
  for (const side of ["left", "right"]) {
    const Side = side === "left" ? "Left" : "Right";
    const rest = tips(vrm, side);
    const moved = (bone) => {
      const node = vrm.humanoid.getNormalizedBoneNode(threeName(bone));
      node.quaternion.set(...version.turned(turns.get(bone)));
      const now = tips(vrm, side).map((tip, at) => tip.sub(rest[at]));
      node.quaternion.set(0, 0, 0, 1);
      return now;
    };
    fingers.forEach((finger, at) => phalanges.forEach((phalanx) => {
      const bone = Side + finger + phalanx, ways = moved(bone);
      // Down, and the thumb also towards the little finger.
      const palm = new THREE.Vector3(0, -1, finger === "Thumb" ? -version.ahead : 0).normalize();
      if (!(ways[at].dot(palm) > 0.002)) fault(`${version.name}: ${bone} moves its tip by ${ways[at].toArray()} m, and not towards the palm`);
      if (ways.some((way, other) => other !== at && way.length() > 1e-6)) fault(`${version.name}: ${bone} moves another finger`);
      checked += 1;
    }));
    const hand = turns.get(`${Side}Hand`), length = Math.hypot(...hand);
    if (Math.abs(length - 1) > 1e-4) fault(`${Side}Hand: no rotation`);
    if (Math.abs(hand[3]) < 0.9999 && moved(`${Side}Hand`).some((way) => way.length() < 1e-4)) fault(`${version.name}: ${Side}Hand moves no finger`);
    checked += 1;
  }
}
if (faults > 0) process.exit(1);
console.log(`avatar: ${checked} bones of avatars of VRM 0 and VRM 1 turn the right way, by three-vrm`);
