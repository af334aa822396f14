// Khronos' validator over GLB files; anything above a hint fails.
const fs = require('fs');
const validator = require('gltf-validator');

(async () => {
  let bad = 0;
  for (const file of process.argv.slice(2)) {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file)), { maxIssues: 20 });
    const { numErrors, numWarnings, numInfos } = report.issues;
    console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings, ${numInfos} notes`);
    for (const issue of report.issues.messages.slice(0, 20))
      if (issue.severity <= 2 || process.env.NOTES) console.log(`  ${issue.code} ${issue.pointer}: ${issue.message}`);
    bad += numErrors + numWarnings;
  }
  process.exit(bad > 0 ? 1 : 0);
})();
