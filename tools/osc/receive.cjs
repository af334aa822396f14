// Prints the OSC that reaches a port, by npm's osc, one message a line: receive.cjs PORT. A type, a blank and a value for each
// argument, as tools/osc/judge.py reads them.
"use strict";
const osc = require("osc");
const port = new osc.UDPPort({ localAddress: "0.0.0.0", localPort: Number(process.argv[2]), metadata: true });
const lines = [];
port.on("message", (message) => {
  lines.push(JSON.stringify([message.address, message.args.map((argument) => argument.type).join(""),
    message.args.map((argument) => argument.value)]));
});
port.on("error", (error) => {
  console.error(`receive.cjs: ${error.message}`);
  process.exit(1);
});
process.on("SIGTERM", () => {
  process.stdout.write(lines.join("\n") + "\n", () => process.exit(0));
});
port.open();
