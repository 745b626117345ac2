// Reads a recording with the official MCAP reader, from its index and as a stream, decodes every message with the
// schema text it carries, and says what is in it. Usage: see kUsage.

import { open, readFile } from "node:fs/promises";
import { createHash } from "node:crypto";
import { parseArgs } from "node:util";

import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import omgidlParser from "@foxglove/omgidl-parser";
import omgidlSerialization from "@foxglove/omgidl-serialization";

const kUsage = `usage: node read_mcap.mjs FILE [--expect EXPECTED.json] [--stream-only]

Prints one JSON object:
  {"topics": {"<topic>": {"type": "<schema name>", "count": <messages>}}, "messages": <n>, "decoded": <n>,
   "attachments": ["<name>", ...], "metadata": ["<name>", ...]}

  --expect       every value in EXPECTED.json must be the same in that object; what it leaves out is not compared
  --stream-only  for a file without a right index: skip the indexed reading

Exit code: 0 all is well; 1 the file is damaged or cut, a message cannot be decoded, the two readings differ, or
something is not as expected; 2 wrong usage.`;

const kStreamPieceBytes = 1 << 16;

class Failure extends Error {}

/// Decodes the messages of a channel by its schema's text; made once for each schema. Nothing for a schema that is not
/// available, which the specification says with an empty encoding.
function makeDecoder(channel, schema) {
  const where = `topic ${channel.topic}`;
  if (schema == undefined) throw new Failure(`${where}: no schema ${channel.schemaId}`);
  if (channel.messageEncoding !== "cdr") throw new Failure(`${where}: message encoding "${channel.messageEncoding}"`);
  if (schema.encoding === "" && schema.data.length === 0) return undefined;
  if (schema.encoding !== "omgidl") throw new Failure(`${where}: schema encoding "${schema.encoding}"`);
  try {
    const definitions = omgidlParser.parseIDL(new TextDecoder("utf-8", { fatal: true }).decode(schema.data));
    return new omgidlSerialization.MessageReader(schema.name, definitions);
  } catch (error) {
    throw new Failure(`${where}: schema ${schema.name} cannot be parsed: ${error.message}`);
  }
}

/// Gathers what one way of reading finds. Contents go into a sum that does not depend on the order of the messages, as
/// the two ways may differ in that.
class Contents {
  channels = new Map();
  schemas = new Map();
  decoders = new Map();
  topics = new Map();
  messages = 0;
  decoded = 0;
  sum = 0n;
  attachments = [];
  metadata = [];

  take(record) {
    switch (record.type) {
      case "Schema":
        this.schemas.set(record.id, record);
        break;
      case "Channel":
        this.takeChannel(record);
        break;
      case "Message":
        this.takeMessage(record);
        break;
      case "Attachment":
        this.attachments.push(record.name);
        this.addToSum([record.name, record.mediaType, record.logTime, record.createTime], record.data);
        break;
      case "Metadata":
        this.metadata.push(record.name);
        this.addToSum([record.name, JSON.stringify([...record.metadata])], new Uint8Array());
        break;
    }
  }

  takeChannel(channel) {
    if (this.channels.has(channel.id)) return;
    const schema = this.schemas.get(channel.schemaId);
    this.channels.set(channel.id, channel);
    this.decoders.set(channel.id, makeDecoder(channel, schema));
    const topic = this.topics.get(channel.topic) ?? { type: schema.name, count: 0 };
    if (topic.type !== schema.name) throw new Failure(`topic ${channel.topic}: both ${topic.type} and ${schema.name}`);
    this.topics.set(channel.topic, topic);
  }

  takeMessage(message) {
    const channel = this.channels.get(message.channelId);
    if (channel == undefined) throw new Failure(`a message before its channel ${message.channelId}`);
    ++this.messages;
    ++this.topics.get(channel.topic).count;
    const decoder = this.decoders.get(message.channelId);
    try {
      decoder?.readMessage(message.data);
    } catch (error) {
      throw new Failure(`topic ${channel.topic}: message ${message.sequence} cannot be decoded: ${error.message}`);
    }
    if (decoder != undefined) ++this.decoded;
    this.addToSum([message.channelId, message.sequence, message.logTime, message.publishTime], message.data);
  }

  addToSum(fields, data) {
    const digest = createHash("sha256").update(fields.join("|")).update("|").update(data).digest();
    this.sum = BigInt.asUintN(64, this.sum + digest.readBigUInt64LE(0));
  }

  summary() {
    return {
      topics: Object.fromEntries([...this.topics].sort(([a], [b]) => (a < b ? -1 : 1))),
      messages: this.messages,
      decoded: this.decoded,
      attachments: [...this.attachments].sort(),
      metadata: [...this.metadata].sort(),
    };
  }
}

async function readAsStream(file, decompressHandlers) {
  const contents = new Contents();
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  let isDataSection = true;
  let dataSectionEnded = false;
  for await (const piece of file.createReadStream({ start: 0, autoClose: false, highWaterMark: kStreamPieceBytes })) {
    reader.append(piece);
    for (let record; (record = reader.nextRecord()); ) {
      if (record.type === "DataEnd") {
        dataSectionEnded = true;
        isDataSection = false;
      }
      if (isDataSection) contents.take(record);  // the summary repeats schemas and channels
    }
  }
  if (!dataSectionEnded || !reader.done()) {
    throw new Failure(`the file is cut: ${reader.bytesRemaining()} bytes are left over and no footer was found`);
  }
  return contents;
}

async function readByIndex(file, decompressHandlers) {
  const { size } = await file.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      const { bytesRead } = await file.read(bytes, 0, bytes.length, Number(offset));
      if (bytesRead !== bytes.length) throw new Failure(`${length} bytes at ${offset} are beyond the end of the file`);
      return bytes;
    },
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const contents = new Contents();
  for (const schema of reader.schemasById.values()) contents.take(schema);
  for (const channel of reader.channelsById.values()) contents.take(channel);
  let latest = 0n;
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    if (message.logTime < latest) throw new Failure(`log time goes back from ${latest} to ${message.logTime}`);
    latest = message.logTime;
    contents.take(message);
  }
  for await (const attachment of reader.readAttachments({ validateCrcs: true })) contents.take(attachment);
  for await (const metadata of reader.readMetadata()) contents.take(metadata);
  checkStatistics(reader, contents);
  return contents;
}

function checkStatistics({ statistics }, contents) {
  if (statistics == undefined) throw new Failure("the summary has no statistics");
  const counted = {
    messageCount: BigInt(contents.messages),
    channelCount: contents.channels.size,
    schemaCount: contents.schemas.size,
    attachmentCount: contents.attachments.length,
    metadataCount: contents.metadata.length,
  };
  for (const [name, value] of Object.entries(counted)) {
    if (statistics[name] !== value) throw new Failure(`statistics: ${name} is ${statistics[name]}, counted ${value}`);
  }
}

/// Where `found` differs from `expected`, as text; nothing when every value in `expected` is the same in `found`.
function difference(expected, found, path = "") {
  if (typeof expected === "object" && expected !== null && !Array.isArray(expected)) {
    for (const [key, value] of Object.entries(expected)) {
      const here = difference(value, found?.[key], path === "" ? key : `${path}.${key}`);
      if (here != undefined) return here;
    }
    return undefined;
  }
  if (JSON.stringify(expected) === JSON.stringify(found)) return undefined;
  return `${path || "value"}: expected ${JSON.stringify(expected)}, found ${JSON.stringify(found) ?? "nothing"}`;
}

function parseCommandLine() {
  try {
    const { values, positionals } = parseArgs({
      allowPositionals: true,
      options: { expect: { type: "string" }, "stream-only": { type: "boolean" }, help: { type: "boolean" } },
    });
    if (values.help) {
      console.log(kUsage);
      process.exit(0);
    }
    if (positionals.length !== 1) throw new Error(`one FILE is needed, ${positionals.length} were given`);
    return { path: positionals[0], expect: values.expect, isStreamOnly: values["stream-only"] ?? false };
  } catch (error) {
    console.error(`read_mcap: ${error.message}\n${kUsage}`);
    process.exit(2);
  }
}

async function main() {
  const { path, expect, isStreamOnly } = parseCommandLine();
  try {
    const decompressHandlers = await loadDecompressHandlers();
    const expected = expect == undefined ? {} : JSON.parse(await readFile(expect, "utf8"));
    const file = await open(path, "r");
    try {
      const streamed = await readAsStream(file, decompressHandlers);
      const summary = streamed.summary();
      if (!isStreamOnly) {
        const indexed = await readByIndex(file, decompressHandlers);
        const mismatch = difference(summary, indexed.summary()) ?? difference(indexed.summary(), summary);
        if (mismatch != undefined) throw new Failure(`indexed and streamed reading differ: ${mismatch}`);
        if (streamed.sum !== indexed.sum) throw new Failure("indexed and streamed reading differ in their contents");
      }
      console.log(JSON.stringify(summary));
      const surprise = difference(expected, summary);
      if (surprise != undefined) throw new Failure(surprise);
    } finally {
      await file.close();
    }
  } catch (error) {
    console.error(`read_mcap: ${path}: ${error instanceof Failure ? error.message : (error.stack ?? error)}`);
    process.exit(1);
  }
}

await main();
