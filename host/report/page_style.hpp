// The page's own style sheet: light, dark and paper, no file or font from elsewhere.
#pragma once

namespace rfmvo::report {

inline constexpr const char* kPageStyle = R"css(
:root{color-scheme:light dark;--bg:#f6f7f9;--card:#fff;--ink:#1c2430;--soft:#5d6878;--grid:#e3e7ed;--line:#dde2e9;
--path:#8a94a3;--good:#1668c7;--doubt:#c96a00;--stale:#8b4fc0;--truth:#1a8a4a;--bad:#c22f2f}
@media (prefers-color-scheme:dark){:root{--bg:#12161c;--card:#1a2028;--ink:#e6eaf0;--soft:#9aa5b4;--grid:#2a323d;
--line:#2f3844;--path:#8592a3;--good:#5aa5ff;--doubt:#f0a04b;--stale:#bf8cf0;--truth:#4cc27e;--bad:#ff7d7d}}
*{box-sizing:border-box}
body{margin:0;background:var(--bg);color:var(--ink);font:15px/1.5 system-ui,-apple-system,"Segoe UI",Roboto,sans-serif}
main{max-width:1240px;margin:0 auto;padding:28px 20px 48px}
h1{font-size:1.5rem;margin:0;overflow-wrap:anywhere}
h2{font-size:1.05rem;margin:0 0 8px}
p{margin:4px 0;color:var(--soft)}
section{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:18px 20px;margin-top:18px}
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(240px,1fr));gap:12px;margin-top:18px}
.card{background:var(--card);border:1px solid var(--line);border-radius:10px;padding:12px 16px}
.card span{display:block;color:var(--soft);font-size:.82rem}
.card b{display:block;font-size:1.4rem;font-weight:650;font-variant-numeric:tabular-nums}
.card small{color:var(--soft)}
svg.plot{display:block;width:100%;height:auto}
svg.plot g,svg.plot text{font-family:inherit}
.legend{margin:6px 0}.legend span{margin-right:16px;white-space:nowrap}.legend i{font-style:normal}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:.86rem;font-variant-numeric:tabular-nums}
th,td{padding:4px 8px;border-bottom:1px solid var(--line);text-align:right;white-space:nowrap}
th{color:var(--soft);font-weight:600}
.text{text-align:left}
td.epc{font-family:ui-monospace,SFMono-Regular,Menlo,Consolas,monospace;font-size:.8rem}
.badge{display:inline-block;border-radius:5px;padding:0 7px;font-size:.76rem;font-weight:600;color:var(--soft);
border:1px solid currentColor}
.good{color:var(--good)}.doubt{color:var(--doubt)}.stale{color:var(--stale)}.bad{color:var(--bad)}
@media print{:root{color-scheme:light;--bg:#fff;--card:#fff;--ink:#000;--soft:#444;--grid:#ddd;--line:#bbb;--path:#777;
--good:#0b4ea2;--doubt:#a85600;--stale:#6b34a0;--truth:#0d6b35;--bad:#a01818}
main{max-width:none;padding:0}section,.card{break-inside:avoid}section.long{break-inside:auto}tr{break-inside:avoid}
body{font-size:11px}table{font-size:.74rem}th,td{padding:2px 5px}.scroll{overflow:visible}
td.epc{white-space:normal;word-break:break-all;min-width:9em;font-size:.7rem}}
)css";

}  // namespace rfmvo::report
