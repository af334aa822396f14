// Reads a file of `nendo export TAKE --out X.mcap` by Foxglove's own readers, which check all checksums, and compares it with
// X.csv of the same take: judge_mcap.cjs FILE.mcap FILE.csv. Reads it by time ranges, and as a stream that is cut off.
"use strict";
const fs = require("node:fs");
const assert = require("node:assert");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");
const fzstd = require("fzstd");

const [, , mcapPath, csvPath] = process.argv;
const file = fs.readFileSync(mcapPath);
const decompressHandlers = { zstd: (buffer, size) => fzstd.decompress(buffer, new Uint8Array(Number(size))) };
const readable = {
  size: async () => BigInt(file.length),
  read: async (offset, size) => new Uint8Array(file.subarray(Number(offset), Number(offset + size))),
};

function tableOf(path) {
  const [head, ...rows] = fs.readFileSync(path, "utf8").trim().split("\n");
  const names = head.split(",");
  return rows.map((row) => Object.fromEntries(row.split(",").map((cell, at) => [names[at], Number(cell)])));
}

// A frame's position in `stage`, by the transforms of one message.
function place(frames, name) {
  const found = frames.get(name);
  const { x, y, z } = found.transform.translation;
  let at = [x, y, z];
  for (let parent = found.header.frame_id; parent !== "stage"; parent = frames.get(parent).header.frame_id) {
    const { translation: t, rotation: q } = frames.get(parent).transform;
    const u = [q.x, q.y, q.z];
    const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    const w = cross(u, at).map((v) => 2 * v);
    const uw = cross(u, w);
    at = at.map((v, k) => v + q.w * w[k] + uw[k]);
    at = [at[0] + t.x, at[1] + t.y, at[2] + t.z];
  }
  return at;
}

async function main() {
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const decoders = new Map();
  for (const [id, channel] of reader.channelsById) {
    const schema = reader.schemasById.get(channel.schemaId);
    assert.equal(schema.encoding, "ros2msg");
    assert.match(channel.metadata.get("topic_type_hash"), /^RIHS01_[0-9a-f]{64}$/);
    decoders.set(id, new MessageReader(parse(new TextDecoder().decode(schema.data), { ros2: true })));
  }
  const begin = reader.statistics.messageStartTime;
  const last = reader.statistics.messageEndTime;
  const byTopic = new Map();
  const ranges = 17n;
  let total = 0n;
  for (let at = 0n; at < ranges; ++at) { // each message is in one range
    const startTime = begin + (at * (last - begin)) / ranges + (at === 0n ? 0n : 1n);
    const endTime = begin + ((at + 1n) * (last - begin)) / ranges;
    for await (const message of reader.readMessages({ startTime, endTime })) {
      const { topic } = reader.channelsById.get(message.channelId);
      const decoded = decoders.get(message.channelId).readMessage(message.data);
      if (!byTopic.has(topic)) byTopic.set(topic, []);
      byTopic.get(topic).push({ time: message.logTime, sequence: message.sequence, decoded });
      ++total;
    }
  }
  assert.equal(total, reader.statistics.messageCount, "each message once");

  const rows = tableOf(csvPath);
  const joints = byTopic.get("/joint_states");
  const tf = byTopic.get("/tf");
  assert.equal(joints.length, rows.length, "a message per row");
  assert.equal(tf.length, rows.length, "transforms per row");
  let angles = 0, worstDeg = 0, worstM = 0;
  rows.forEach((row, at) => {
    assert.equal(joints[at].sequence, at);
    const stamp = joints[at].decoded.header.stamp;
    assert.equal(BigInt(stamp.sec) * 1000000000n + BigInt(stamp.nsec ?? stamp.nanosec), joints[at].time, "stamp");
    const sinceFirst = Number(joints[at].time - joints[0].time) / 1e9;
    assert.ok(Math.abs(sinceFirst - (row.time_s - rows[0].time_s)) < 1.1e-6, `time of row ${at}`);
    joints[at].decoded.name.forEach((name, k) => {
      const degrees = (joints[at].decoded.position[k] * 180) / Math.PI;
      worstDeg = Math.max(worstDeg, Math.abs(degrees - row[`${name}_deg`]));
      ++angles;
    });
    const frames = new Map(tf[at].decoded.transforms.map((one) => [one.child_frame_id, one]));
    for (const column of Object.keys(row).filter((name) => name.endsWith("_tip_x_m"))) {
      const tip = column.slice(0, -"_x_m".length);
      const [x, y, z] = place(frames, tip); // of ROS: ahead, left, up
      for (const [found, axis] of [[-y, "x"], [z, "y"], [-x, "z"]])
        worstM = Math.max(worstM, Math.abs(found - row[`${tip}_${axis}_m`]));
    }
  });
  assert.ok(angles >= 10 * rows.length, "angles");
  // The table rounds to 4 digits of a degree, and to 7 of a metre.
  assert.ok(worstDeg <= 0.5e-4 + 1e-9, `an angle is off by ${worstDeg} degrees`);
  assert.ok(worstM <= 0.5e-7 + 1e-12, `a fingertip is off by ${worstM} m`);
  assert.equal(byTopic.get("/tf_static").length, 1);

  // Cut at the end of a chunk, the file has the messages of that chunk and of those before it; cut later, the same ones.
  const streamed = (bytes) => {
    const stream = new McapStreamReader({ decompressHandlers });
    stream.append(new Uint8Array(file.subarray(0, bytes)));
    let messages = 0;
    for (let record; (record = stream.nextRecord());) if (record.type === "Message") ++messages;
    return messages;
  };
  const ends = reader.chunkIndexes.map((chunk) => Number(chunk.chunkStartOffset + chunk.chunkLength)).sort((a, b) => a - b);
  const counts = ends.map(streamed);
  assert.equal(BigInt(counts.at(-1)), total, "all messages in a stream");
  assert.ok(counts.every((count, at) => count > (at > 0 ? counts[at - 1] : 0)), "messages of each chunk");
  const cuts = 25;
  for (let at = 1; at <= cuts; ++at) {
    const cut = Math.floor((file.length * at) / (cuts + 1));
    const whole = ends.filter((end) => end <= cut).length;
    assert.equal(streamed(cut), whole > 0 ? counts[whole - 1] : 0, `cut at ${cut}`);
  }
  const commands = (byTopic.get("/nendo/commands") ?? []).map((one) => one.decoded.data);
  console.log(`${mcapPath}: ${total} messages in ${reader.chunkIndexes.length} chunks, ${rows.length} frames and ${angles} angles ` +
    `equal to the table (${worstDeg.toExponential(1)} degrees, ${worstM.toExponential(1)} m), ${cuts} cuts` +
    (commands.length > 0 ? `, commands: ${commands.join(", ")}` : ""));
}

main().catch((error) => {
  console.error(`${mcapPath}: ${error.message}`);
  process.exit(1);
});
