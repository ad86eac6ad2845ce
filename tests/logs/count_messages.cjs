// Reads an MCAP file by its index and prints {"messages": {topic: number}, "schemas": {topic: name}}.
// node count_messages.cjs FILE; needs @mcap/core and, for node before 22.15, fzstd.
const fs = require("node:fs/promises");
const zlib = require("node:zlib");
const { McapIndexedReader } = require("@mcap/core");

const decompress = zlib.zstdDecompressSync ?? require("fzstd").decompress;

async function main(path) {
  const file = await fs.open(path);
  const { size } = await file.stat();
  const readable = {
    size: async () => BigInt(size),
    read: async (offset, length) => {
      const buffer = new Uint8Array(Number(length));
      await file.read(buffer, 0, Number(length), Number(offset));
      return buffer;
    },
  };
  const reader = await McapIndexedReader.Initialize({
    readable,
    decompressHandlers: { zstd: (data) => decompress(data) },
  });
  const messages = {};
  const schemas = {};
  for (const channel of reader.channelsById.values()) {
    schemas[channel.topic] = reader.schemasById.get(channel.schemaId).name;
  }
  let before = 0n;
  for await (const message of reader.readMessages()) {
    const { topic } = reader.channelsById.get(message.channelId);
    messages[topic] = (messages[topic] ?? 0) + 1;
    if (message.logTime < before) throw new Error(`${topic} goes back in time`);
    before = message.logTime;
  }
  await file.close();
  console.log(JSON.stringify({ messages, schemas }));
}

main(process.argv[2]);
