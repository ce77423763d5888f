// read_ros2.mjs FILE: what @mcap/core and @foxglove/rosmsg2-serialization, which are not Thimble's, find in a ROS 2 log, as JSON: its
// profile, and of each topic the schema and every message, as its own definition says. Exit code 1, and why, if they cannot.
import { open } from "node:fs/promises";
import { McapIndexedReader } from "@mcap/core";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";

const file = await open(process.argv[2]);
const { size } = await file.stat();
const reader = await McapIndexedReader.Initialize({
  readable: {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  },
});
const found = { profile: reader.header.profile, topics: {} };
const readers = new Map();
for (const schema of reader.schemasById.values()) {
  if (schema.encoding !== "ros2msg") throw new Error(`${schema.name} has encoding ${schema.encoding}`);
  const definition = parse(new TextDecoder().decode(schema.data), { ros2: true });
  readers.set(schema.id, new MessageReader(definition));
}
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  if (channel.messageEncoding !== "cdr") throw new Error(`${channel.topic} is ${channel.messageEncoding}`);
  const type = reader.schemasById.get(channel.schemaId).name;
  const topic = (found.topics[channel.topic] ??= { type, messages: [] });
  const value = readers.get(channel.schemaId).readMessage(message.data);
  topic.messages.push({ log_time_ns: String(message.logTime), value });
}
// Arrays of numbers come as typed arrays, which JSON would turn into objects.
console.log(JSON.stringify(found, (_, value) => (ArrayBuffer.isView(value) ? Array.from(value) : value)));
