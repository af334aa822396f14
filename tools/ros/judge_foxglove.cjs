// Watches a run of nendo by Foxglove's own client, @foxglove/ws-protocol, and compares what came with the recording of that run,
// exported for ROS 2: judge_foxglove.cjs NENDO FOLDER. Tries both subprotocols, and none.
"use strict";
const fs = require("node:fs");
const path = require("node:path");
const assert = require("node:assert");
const { execFileSync, spawn } = require("node:child_process");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { McapStreamReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const fzstd = require("fzstd");
const WebSocket = require("ws");

const [, , nendo, folder] = process.argv;
const take = path.join(folder, "live.nendo");
const exported = path.join(folder, "live.mcap");

function statusOf(address, protocols) { // of a handshake that is refused
  return new Promise((resolve) => {
    const socket = new WebSocket(address, protocols);
    socket.on("unexpected-response", (request, response) => resolve(response.statusCode));
    socket.on("open", () => resolve(101));
    socket.on("error", () => {});
  });
}

function watch(address, protocol) { // until the run ends
  return new Promise((resolve, reject) => {
    const socket = new WebSocket(address, [protocol], { headers: { Origin: "https://app.foxglove.dev" } });
    const client = new FoxgloveClient({ ws: socket });
    const readers = new Map();
    const seen = { protocol, topics: [], messages: new Map(), problems: [] };
    client.on("serverInfo", (info) => assert.deepEqual(info.capabilities, []));
    client.on("status", (status) => seen.problems.push(status.message));
    client.on("advertise", (channels) => {
      for (const channel of channels) {
        seen.topics.push(channel.topic);
        seen.messages.set(channel.topic, []);
        const reader = new MessageReader(parse(channel.schema, { ros2: true }));
        readers.set(client.subscribe(channel.id), { topic: channel.topic, reader });
      }
    });
    client.on("message", ({ subscriptionId, timestamp, data }) => {
      const { topic, reader } = readers.get(subscriptionId);
      seen.messages.get(topic).push({ time: timestamp, decoded: reader.readMessage(data) });
    });
    client.on("error", reject);
    client.on("close", () => resolve(seen));
  });
}

function recorded() { // the joint states and transforms of the recording, by topic
  const stream = new McapStreamReader({
    decompressHandlers: { zstd: (buffer, size) => fzstd.decompress(buffer, new Uint8Array(Number(size))) } });
  stream.append(new Uint8Array(fs.readFileSync(exported)));
  const schemas = new Map(), channels = new Map(), messages = new Map();
  for (let record; (record = stream.nextRecord());) {
    if (record.type === "Schema") schemas.set(record.id, new MessageReader(parse(new TextDecoder().decode(record.data), { ros2: true })));
    if (record.type === "Channel") channels.set(record.id, { topic: record.topic, reader: schemas.get(record.schemaId) });
    if (record.type !== "Message") continue;
    const { topic, reader } = channels.get(record.channelId);
    if (!messages.has(topic)) messages.set(topic, []);
    messages.get(topic).push({ time: record.logTime, decoded: reader.readMessage(record.data) });
  }
  return messages;
}

const key = (decoded) => Array.from(decoded.position).join(" ");

function compare(seen, messages) {
  assert.deepEqual(seen.topics, ["/joint_states", "/tf", "/tf_static", "/nendo/model"]);
  assert.deepEqual(seen.problems, []);
  const ticks = messages.get("/joint_states");
  const joints = seen.messages.get("/joint_states"), tf = seen.messages.get("/tf");
  assert.ok(joints.length > 0.2 * ticks.length, `${joints.length} joint states of ${ticks.length} ticks`);
  assert.equal(tf.length, joints.length);
  let worst = 0, before = -1;
  joints.forEach(({ time, decoded }, n) => {
    // Both clocks are read twice, when the run begins and at each message.
    const near = (other) => Math.abs(Number(time - other.time)) < 1e6;
    const tick = ticks.findIndex((other, number) => number > before && near(other));
    assert.ok(tick >= 0, `joint state ${n} is of no later tick`);
    before = tick;
    assert.equal(key(decoded), key(ticks[tick].decoded), `angles of joint state ${n}`); // bit for bit
    assert.deepEqual(Array.from(decoded.name), Array.from(ticks[tick].decoded.name));
    const own = new Map(messages.get("/tf")[tick].decoded.transforms.map((one) => [one.child_frame_id, one]));
    for (const one of tf[n].decoded.transforms) {
      const other = own.get(one.child_frame_id);
      assert.equal(one.header.frame_id, other.header.frame_id);
      for (const part of ["translation", "rotation"])
        for (const axis of Object.keys(one.transform[part]))
          worst = Math.max(worst, Math.abs(one.transform[part][axis] - other.transform[part][axis]));
    }
  });
  assert.ok(worst < 1e-12, `a transform is off by ${worst}`);
  assert.equal(seen.messages.get("/tf_static").length, 1);
  const models = seen.messages.get("/nendo/model");
  assert.ok(models.length >= 2 && models.length <= joints.length, `${models.length} models`);
  for (const { decoded } of models) {
    const [{ triangles: [surface] }] = decoded.entities;
    assert.ok(surface.indices.length > 0 && surface.indices.every((corner) => corner < surface.points.length));
  }
  console.log(`${seen.protocol}: ${joints.length} joint states and transforms of ${ticks.length} ticks, equal to the recording's; ` +
    `${models.length} models of ${models[0].decoded.entities[0].triangles[0].points.length} vertices`);
}

async function main() {
  const run = spawn(nendo, ["run", "--left", "sim:sculpt?seed=7", "--right", "sim:grasp", "--rate", "90", "--duration", "5", "--web", "0",
    "--mesh", "apps/models/moai.obj", "--out", path.join(folder, "live.ply"), "--record", take, "--json"], { stdio: ["ignore", "ignore", "pipe"] });
  let said = "";
  const address = await new Promise((resolve, reject) => {
    run.stderr.on("data", (bytes) => {
      said += bytes;
      const found = said.match(/ws:\/\/\S+/);
      if (found) resolve(found[0]);
    });
    run.on("exit", () => reject(new Error(`the run ended: ${said}`)));
  });
  const page = address.replace("ws:", "http:").replace("/foxglove", "/model");
  while ((await fetch(page)).status !== 200) await new Promise((resolve) => setTimeout(resolve, 20)); // until the loop begins
  assert.equal(await statusOf(address, "another.protocol"), 400, "another subprotocol");
  assert.equal(await statusOf(address, []), 400, "no subprotocol");
  assert.equal(await statusOf(address.replace(/token=.*/, "token=0"), "foxglove.sdk.v1"), 403, "another token");
  const ended = new Promise((resolve) => run.on("exit", resolve));
  const all = await Promise.all(["foxglove.sdk.v1", "foxglove.websocket.v1"].map((protocol) => watch(address, protocol)));
  assert.equal(await ended, 0, said);
  execFileSync(nendo, ["export", take, "--out", exported]);
  const messages = recorded();
  for (const seen of all) compare(seen, messages);
}

main().catch((error) => {
  console.error(`judge_foxglove.cjs: ${error.stack}`);
  process.exit(1);
});
