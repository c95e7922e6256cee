// Tables as CSV files, made from the page's own data when they are asked for.

// A text that would be a formula in a spreadsheet begins with an apostrophe.
const plain = (cell) => (typeof cell === "string" && /^[=+\-@\t\r]/.test(cell) ? `'${cell}` : String(cell));
const quoted = (cell) => (/[",\n]/.test(plain(cell)) ? `"${plain(cell).replaceAll('"', '""')}"` : plain(cell));
const csv = (rows) => `${rows.map((row) => row.map(quoted).join(",")).join("\n")}\n`;

function boundsTable() {
  const kinds = ["lower", "upper", "nominal", "error"];
  const columns = DATA.responses.flatMap((r) => kinds.filter((kind) => r[kind]).map((kind) => [`${r.name}_${kind} (${r.units})`, r[kind]]));
  const rows = [["time (s)", ...columns.map(([name]) => name)]];
  TIME.forEach((time, i) => rows.push([time, ...columns.map(([, values]) => values[i])]));
  return rows;
}

function runsTable() {
  const rows = [["run", "role", ...DATA.parameters.map(({ name, units }) => `${name} (${units})`)]];
  for (const { id, role, values } of DATA.runs) rows.push([id, role, ...values]);
  return rows;
}

function eventsTable() {
  const rows = [["run", "time (s)", "contact", "closes"]];
  for (const { id, events } of DATA.runs) for (const e of events) rows.push([id, e.time, e.contact, e.closing ? 1 : 0]);
  return rows;
}

const TABLES = { Bounds: ["bounds", boundsTable], Runs: ["runs", runsTable], "Contact events": ["events", eventsTable] };

function download(name, text) {
  const address = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
  make("a", { href: address, download: name }).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

function drawTables() {
  for (const [title, [name, table]] of Object.entries(TABLES)) {
    const button = make("button", { type: "button", "data-table": name }, `${title} (CSV)`);
    button.addEventListener("click", () => download(`${DATA.campaign}-${name}.csv`, csv(table())));
    byId("downloads").append(button);
  }
}
