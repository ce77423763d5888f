// read_log.mjs FILE: what @mcap/core, which is not Thimble's, finds in a log, as JSON. It reads the file twice: from front to
// back, with every CRC checked, and by the index. Exit code 1, and why, if it cannot.
import { open } from "node:fs/promises";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";

const file = await open(process.argv[2]);
const { size } = await file.stat();
const read = async (offset, length) => {
  const bytes = new Uint8Array(Number(length));
  await file.read(bytes, 0, bytes.length, Number(offset));
  return bytes;
};

const stream = new McapStreamReader({ validateCrcs: true });
stream.append(await read(0, size));
const found = { messages: {}, schemas: [], attachments: [], metadata: [], times_go_up: true };
const topics = new Map();
for (let record = stream.nextRecord(); record != undefined; record = stream.nextRecord()) {
  if (record.type === "Channel") topics.set(record.id, record.topic);
  if (record.type === "Message") {
    const topic = topics.get(record.channelId);
    found.messages[topic] = (found.messages[topic] ?? 0) + 1;
  }
}
if (!stream.done()) throw new Error("the file does not end where it should");

const indexed = await McapIndexedReader.Initialize({
  readable: { size: async () => BigInt(size), read },
});
let count = 0;
let last = 0n;
for await (const message of indexed.readMessages()) {
  ++count;
  found.times_go_up &&= message.logTime >= last;
  last = message.logTime;
}
found.indexed = count;
found.statistics = Number(indexed.statistics.messageCount);
for (const schema of indexed.schemasById.values()) {
  found.schemas.push([schema.name, schema.encoding, Buffer.from(schema.data.subarray(4, 8)).toString()]);
}
for await (const attachment of indexed.readAttachments()) found.attachments.push(attachment.name);
for await (const metadata of indexed.readMetadata()) found.metadata.push(metadata.name);
console.log(JSON.stringify(found));
