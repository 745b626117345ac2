// Prints every message of a recording as the official reader and decoder see it: one JSON object a line,
//   {"topic": ..., "writer": ..., "sequence": ..., "log_time_ns": ..., "publish_time_ns": ..., "message": {...}}
// 64-bit integers with all their digits, what is not finite and enumerators as strings, octets in hex.
// Usage: node print_mcap.mjs FILE

import { open } from "node:fs/promises";

import { McapIndexedReader } from "@mcap/core";
import { loadDecompressHandlers } from "@mcap/support";
import omgidlParser from "@foxglove/omgidl-parser";
import omgidlSerialization from "@foxglove/omgidl-serialization";

/// Knows a schema's types by name and reads its messages.
class Schema {
  constructor({ name, data }) {
    this.definitions = omgidlParser.parseIDL(new TextDecoder("utf-8", { fatal: true }).decode(data));
    this.types = new Map(this.definitions.map((definition) => [definition.name, definition]));
    this.root = this.types.get(name);
    this.reader = new omgidlSerialization.MessageReader(name, this.definitions);
  }

  textOf(payload) {
    return this.structText(this.root, this.reader.readMessage(payload));
  }

  structText(type, value) {
    const members = type.definitions.map((field) => `"${field.name}":${this.fieldText(field, value[field.name])}`);
    return `{${members.join()}}`;
  }

  fieldText(field, value) {
    if (value instanceof Uint8Array) return `"${Buffer.from(value).toString("hex")}"`;
    if (Array.isArray(value) || ArrayBuffer.isView(value)) {
      return `[${Array.from(value, (element) => this.fieldText(field, element)).join()}]`;
    }
    if (field.enumType != undefined) return `"${this.types.get(field.enumType).definitions[value].name}"`;
    if (field.isComplex) return this.structText(this.types.get(field.type), value);
    if (typeof value === "bigint") return value.toString();
    if (typeof value === "number" && !Number.isFinite(value)) return `"${value}"`;
    return Object.is(value, -0) ? "-0.0" : JSON.stringify(value);
  }
}

const file = await open(process.argv[2], "r");
const { size } = await file.stat();
const readable = {
  size: async () => BigInt(size),
  read: async (offset, length) => {
    const bytes = new Uint8Array(Number(length));
    await file.read(bytes, 0, bytes.length, Number(offset));
    return bytes;
  },
};
const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers: await loadDecompressHandlers() });
const schemas = new Map([...reader.schemasById].map(([id, schema]) => [id, new Schema(schema)]));
for await (const message of reader.readMessages()) {
  const channel = reader.channelsById.get(message.channelId);
  process.stdout.write(
    `{"topic":${JSON.stringify(channel.topic)},"writer":${JSON.stringify(channel.metadata.get("writer"))},` +
      `"sequence":${message.sequence},"log_time_ns":${message.logTime},"publish_time_ns":${message.publishTime},` +
      `"message":${schemas.get(channel.schemaId).textOf(message.data)}}\n`,
  );
}
await file.close();
