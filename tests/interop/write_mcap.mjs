// Writes recordings with the official MCAP writer, for Baton's own reader to be tested on. Usage: see kUsage.

import { mkdir, open, writeFile } from "node:fs/promises";
import { join } from "node:path";

import { McapWriter } from "@mcap/core";
import omgidlParser from "@foxglove/omgidl-parser";
import omgidlSerialization from "@foxglove/omgidl-serialization";
import zstd from "@foxglove/wasm-zstd";
import lz4 from "lz4js";

const kUsage = `usage: node write_mcap.mjs OUTDIR

Creates OUTDIR if needed and writes into it:
  none.mcap  lz4.mcap  zstd.mcap  chunks with that compression, fully indexed
  unchunked.mcap                  messages outside of chunks
  no_summary.mcap                 chunks, but nothing behind the data except the footer
  unknown_record.mcap             zstd chunks, with records between them that no specification knows
  overlapping.mcap                chunks whose log times overlap
  expected.json                   {"<file>": {"topics": ..., "messages": ..., "attachments": [...], "metadata": [...]}}

Exit code: 0 all is well; 1 a file could not be written; 2 wrong usage.`;

const kType = "baton::msg::PlantState";
const kSchema = `module baton { module msg {
  @final
  struct PlantState {
    unsigned long long step;
    long long time_ns;
    sequence<double, 8> position;
    string<32> holder;
  };
}; };
`;
const kMessages = 1000;
const kStepNs = 1_000_000n;
const kUnknownOpcode = 0x80;

/// The file as McapWriter wants it.
class Output {
  #file;
  #position = 0n;

  constructor(file) {
    this.#file = file;
  }
  position() {
    return this.#position;
  }
  async write(bytes) {
    let written = 0;
    while (written < bytes.byteLength) {
      const { bytesWritten } = await this.#file.write(bytes, written, bytes.byteLength - written);
      written += bytesWritten;
    }
    this.#position += BigInt(bytes.byteLength);
  }
}

function unknownRecord() {
  const body = new TextEncoder().encode("of no interest to a reader");
  const bytes = new Uint8Array(9 + body.length);
  const view = new DataView(bytes.buffer);
  view.setUint8(0, kUnknownOpcode);
  view.setBigUint64(1, BigInt(body.length), true);
  bytes.set(body, 9);
  return bytes;
}

/// Writes one file and returns what a reader must find in it.
async function writeFixture(path, { logTime = (step) => step * kStepNs, hasUnknownRecords = false, ...options }) {
  const file = await open(path, "w");
  try {
    const output = new Output(file);
    const writer = new McapWriter({ writable: output, chunkSize: 8192, ...options });
    const cdr = new omgidlSerialization.MessageWriter(kType, omgidlParser.parseIDL(kSchema));
    await writer.start({ profile: "", library: "interop fixture" });
    const schemaId = await writer.registerSchema({
      name: kType,
      encoding: "omgidl",
      data: new TextEncoder().encode(kSchema),
    });
    const topics = ["baton/plant_state", "baton/shadow"];
    const channelIds = [];
    for (const topic of topics) {
      const metadata = new Map([["service", "plant"]]);
      channelIds.push(await writer.registerChannel({ schemaId, topic, messageEncoding: "cdr", metadata }));
    }
    const counts = [0, 0];
    for (let i = 0; i < kMessages; ++i) {
      const channel = i % 4 === 3 ? 1 : 0;
      const step = BigInt(i);
      const data = cdr.writeMessage({
        step,
        time_ns: step * kStepNs,
        position: [i / 7, -i / 3, Math.sin(i)],
        holder: "joint_pd",
      });
      await writer.addMessage({
        channelId: channelIds[channel],
        sequence: counts[channel],
        logTime: logTime(step),
        publishTime: step * kStepNs,
        data,
      });
      ++counts[channel];
      // Past the writer's back, so its CRC of the data section does not cover it.
      if (hasUnknownRecords && i % 300 === 299) await output.write(unknownRecord());
    }
    await writer.addMetadata({ name: "manifest", metadata: new Map([["seed", "7"]]) });
    await writer.addAttachment({
      name: "scenario.yaml",
      mediaType: "text/yaml",
      logTime: 1n,
      createTime: 2n,
      data: new TextEncoder().encode("robot: rpp\n"),
    });
    await writer.end();
    return {
      topics: Object.fromEntries(topics.map((topic, i) => [topic, { type: kType, count: counts[i] }])),
      messages: kMessages,
      attachments: ["scenario.yaml"],
      metadata: ["manifest"],
    };
  } finally {
    await file.close();
  }
}

async function writeAll(folder) {
  await zstd.isLoaded;
  const compressLz4 = (data) => ({ compression: "lz4", compressedData: lz4.compress(data) });
  const compressZstd = (data) => ({ compression: "zstd", compressedData: new Uint8Array(zstd.compress(data)) });
  const nothing = {
    useStatistics: false,
    useSummaryOffsets: false,
    repeatSchemas: false,
    repeatChannels: false,
    useAttachmentIndex: false,
    useMetadataIndex: false,
    useMessageIndex: false,
    useChunkIndex: false,
  };
  const fixtures = {
    "none.mcap": {},
    "lz4.mcap": { compressChunk: compressLz4 },
    "zstd.mcap": { compressChunk: compressZstd },
    "unchunked.mcap": { useChunks: false },
    "no_summary.mcap": { compressChunk: compressZstd, ...nothing },
    "unknown_record.mcap": { compressChunk: compressZstd, hasUnknownRecords: true },
    "overlapping.mcap": { logTime: (step) => ((step * 37n) % BigInt(kMessages)) * kStepNs },
  };
  await mkdir(folder, { recursive: true });
  const expected = {};
  for (const [name, options] of Object.entries(fixtures)) {
    expected[name] = await writeFixture(join(folder, name), options);
  }
  await writeFile(join(folder, "expected.json"), JSON.stringify(expected, undefined, 2) + "\n");
  console.log(JSON.stringify(Object.keys(fixtures)));
}

const folders = process.argv.slice(2);
if (folders.length === 1 && folders[0] === "--help") {
  console.log(kUsage);
} else if (folders.length !== 1 || folders[0].startsWith("-")) {
  console.error(`write_mcap: one OUTDIR is needed\n${kUsage}`);
  process.exitCode = 2;
} else {
  try {
    await writeAll(folders[0]);
  } catch (error) {
    console.error(`write_mcap: ${error.stack ?? error}`);
    process.exitCode = 1;
  }
}
