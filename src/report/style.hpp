// The style of all pages. Not installed.
#pragma once

#include <string_view>

namespace dartcast {

/// CSS. Each of the colours c0 to c7 has a contrast of 3 or more to the page. Any two of them differ for all kinds of
/// colour-blind people (tests/report/colours_test.cpp). The first two are of M. Okabe and K. Ito. The viewer and the
/// charts use the variables.
inline constexpr std::string_view page_style = R"css(
:root{--background:#fff;--panel:#f6f7f9;--text:#1b1f24;--muted:#5b6570;--line:#aab3bd;--faint:#e3e7eb;--accent:#0072b2;--wall:#cfd6de;--rim:#66788c;--axis-y:#2e7d32;
--c0:#0072b2;--c1:#d55e00;--c2:#8c00ff;--c3:#c76c8f;--c4:#782900;--c5:#3f1da3;--c6:#454545;--c7:#a3895b}
@media (prefers-color-scheme:dark){:root{--background:#14171b;--panel:#1d2127;--text:#e6e9ed;--muted:#9aa4af;--line:#5a6572;
--faint:#2b313a;--accent:#56b4e9;--wall:#a9b6c4;--rim:#c4dcf2;--axis-y:#7bc47f;
--c0:#56b4e9;--c1:#f08040;--c2:#41825a;--c3:#a930ff;--c4:#ffc700;--c5:#bbffc9;--c6:#a3b2b6;--c7:#f3ff8e}}
*{box-sizing:border-box}
body{margin:0;background:var(--background);color:var(--text);font:15px/1.45 system-ui,sans-serif}
header,main{max-width:1240px;margin:0 auto;padding:0 16px}
header{padding-top:18px}
h1{font-size:22px;margin:0}
header p{margin:4px 0 12px;color:var(--muted);max-width:100ch}
#view{position:relative;border:1px solid var(--faint);border-radius:8px;overflow:hidden;background:var(--panel)}
#view .fallback{margin:0;padding:10px 14px;color:var(--muted)}
#view .picture{display:block;width:100%;max-height:520px}
.charts{display:grid;grid-template-columns:repeat(auto-fill,minmax(min(100%,480px),1fr));gap:14px;margin:18px 0}
.chart{margin:0;padding:8px;border:1px solid var(--faint);border-radius:8px;background:var(--panel)}
.chart svg{display:block;width:100%;height:auto;font:12px system-ui,sans-serif;fill:var(--text)}
.chart .title{font-weight:600;font-size:13px}
.chart .grid{stroke:var(--faint)}
.chart .axis{stroke:var(--line)}
.tables{display:flex;flex-wrap:wrap;gap:14px;margin:18px 0}
.table{border:1px solid var(--faint);border-radius:8px;background:var(--panel);padding:8px 14px;flex:1 1 300px;min-width:0}
.table h3{font-size:13px;margin:2px 0}
.table td,.table th{white-space:nowrap}
code{background:var(--faint);border-radius:4px;padding:1px 5px;overflow-wrap:anywhere}
.notes{color:var(--muted);margin:12px 0}
details{margin:12px 0;border:1px solid var(--faint);border-radius:8px;padding:8px 14px;background:var(--panel)}
summary{cursor:pointer;font-weight:600}
.wide{overflow-x:auto}
table{border-collapse:collapse;margin:8px 0;font-variant-numeric:tabular-nums}
th,td{padding:2px 14px 2px 0;text-align:left;vertical-align:top;font-weight:400;border-bottom:1px solid var(--faint)}
th{color:var(--muted)}
td{overflow-wrap:anywhere}
pre{overflow-x:auto;font-size:13px}
@media print{#view .controls{display:none}details{break-inside:avoid}}
)css";

}  // namespace dartcast
