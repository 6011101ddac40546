#include "graticule/io/html.hpp"

#include "graticule/io/plot_style.hpp"
#include "graticule/io/svg.hpp"

namespace graticule::html {
namespace {

constexpr const char* kCss = R"(
:root{--ink:#1c2026;--soft:#5d6570;--line:#dde1e6;--page:#fff;--card:#f5f6f8;--bar:#d5e6f3;
--good:#006b4f;--good-back:#dcf3ea;--fair:#7a5200;--fair-back:#fdf0d2;--bad:#9c2a10;
--bad-back:#fbe3dc}
*{box-sizing:border-box}
body{margin:0 auto;max-width:1180px;padding:24px 20px 48px;background:var(--page);color:var(--ink);
font:14px/1.5 "DejaVu Sans",Verdana,Arial,sans-serif}
h1{font-size:21px;margin:0 0 4px;overflow-wrap:anywhere}
h2{font-size:16px;margin:30px 0 8px;padding-bottom:4px;border-bottom:1px solid var(--line)}
p{margin:6px 0}
.soft{color:var(--soft)}
.verdict{display:inline-block;padding:2px 11px;border-radius:12px;font-weight:bold}
.verdict.good{color:var(--good);background:var(--good-back)}
.verdict.fair{color:var(--fair);background:var(--fair-back)}
.verdict.bad{color:var(--bad);background:var(--bad-back)}
.cards{display:grid;grid-template-columns:repeat(auto-fill,minmax(165px,1fr));gap:10px;
margin:18px 0 0}
.card{background:var(--card);border:1px solid var(--line);border-radius:6px;padding:9px 12px}
.card .name{color:var(--soft);font-size:12px}
.card .value{font-size:18px;font-weight:bold;overflow-wrap:anywhere}
.card .note{color:var(--soft);font-size:12px}
.scroll{overflow-x:auto}
table{border-collapse:collapse;width:100%;font-size:13px;margin:6px 0 12px}
th{text-align:left;color:var(--soft);font-weight:normal;font-size:12px;vertical-align:bottom}
th,td{padding:4px 8px 4px 6px;border-bottom:1px solid var(--line)}
td{overflow-wrap:anywhere}
.number{text-align:right;white-space:nowrap;font-variant-numeric:tabular-nums}
td.name{white-space:nowrap}
td.best{font-weight:bold;color:var(--good)}
td.bad{color:var(--bad)}
td.key{font-family:"DejaVu Sans Mono",Menlo,Consolas,monospace;font-size:12px}
figure{margin:10px 0 16px}
figure svg{display:block;max-width:100%;height:auto}
.pair{display:grid;grid-template-columns:repeat(auto-fit,minmax(min(100%,480px),1fr));gap:0 24px}
details{margin:8px 0}
summary{cursor:pointer;color:var(--soft)}
ul{margin:6px 0;padding-left:20px}
li.warning{color:var(--fair)}
@media screen and (prefers-color-scheme:dark){
:root{--ink:#e6e8eb;--soft:#a2a9b3;--line:#2f353e;--page:#101318;--card:#181c22;--bar:#1d3a50;
--good:#56d3a6;--good-back:#123328;--fair:#f0c060;--fair-back:#3a2c0c;--bad:#ff9176;
--bad-back:#43190f}
)";

constexpr const char* kPrintCss = R"(@media print{
body{max-width:none;padding:0;font-size:11px}
h2{break-after:avoid}
figure,.card,tr{break-inside:avoid}
td,.card,.verdict{-webkit-print-color-adjust:exact;print-color-adjust:exact}
}
)";

std::string Class(std::string_view css) {
  return css.empty() ? std::string() : " class=\"" + EscapeXml(css) + "\"";
}

std::string Tagged(const std::string& tag, std::string_view css, std::string_view text) {
  return "<" + tag + Class(css) + ">" + EscapeXml(text) + "</" + tag + ">";
}

std::string Row(const std::vector<Column>& columns, const std::vector<Cell>& cells) {
  std::string row = "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i) {
    std::string css = cells[i].css;
    if (i < columns.size() && columns[i].number) css += css.empty() ? "number" : " number";
    row += "<td" + Class(css);
    if (cells[i].bar >= 0) {
      const std::string percent = SvgNumber(100 * (cells[i].bar < 1 ? cells[i].bar : 1)) + "%";
      row += " style=\"background:linear-gradient(to right,var(--bar) " + percent +
             ",transparent " + percent + ")\"";
    }
    row += ">" + EscapeXml(cells[i].text) + "</td>";
  }
  return row + "</tr>\n";
}

}  // namespace

std::string Table(const std::vector<Column>& columns, const std::vector<std::vector<Cell>>& rows) {
  std::string table = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const Column& column : columns) {
    table += "<th" + Class(column.number ? "number" : "");
    if (!column.hint.empty()) table += " title=\"" + EscapeXml(column.hint) + "\"";
    table += ">" + EscapeXml(column.name) + "</th>";
  }
  table += "</tr></thead>\n<tbody>\n";
  for (const auto& row : rows) table += Row(columns, row);
  return table + "</tbody></table></div>\n";
}

std::string Cards(const std::vector<Card>& cards) {
  std::string out = "<div class=\"cards\">\n";
  for (const Card& card : cards)
    out += "<div class=\"card\">" + Tagged("div", "name", card.name) +
           Tagged("div", "value", card.value) + Tagged("div", "note", card.note) + "</div>\n";
  return out + "</div>\n";
}

std::string Section(std::string_view title, std::string_view html) {
  std::string section = "<section>\n" + Tagged("h2", "", title) + "\n";
  section += html;
  return section + "</section>\n";
}

std::string Details(std::string_view title, std::string_view html) {
  std::string details = "<details>" + Tagged("summary", "", title) + "\n";
  details += html;
  return details + "</details>\n";
}

std::string Figure(std::string_view svg) {
  // What stands before the root element (an XML declaration) has no place inside a page.
  const std::size_t root = svg.find("<svg");
  if (root == std::string_view::npos) return {};
  return "<figure>" + std::string(svg.substr(root)) + "</figure>\n";
}

std::string Paragraph(std::string_view text, std::string_view css) {
  return Tagged("p", css, text) + "\n";
}

std::string List(const std::vector<std::string>& items) {
  std::string list = "<ul>\n";
  for (const std::string& item : items) list += Tagged("li", "", item) + "\n";
  return list + "</ul>\n";
}

std::string Page(std::string_view title, std::string_view header_html, std::string_view body_html) {
  std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n";
  page += Tagged("title", "", title) + "\n<style>" + kCss + PlotDarkCss() + "\n}\n" + kPrintCss +
          "</style>\n</head>\n<body>\n<header>\n";
  page += header_html;
  page += "</header>\n<main>\n";
  page += body_html;
  return page + "</main>\n</body>\n</html>\n";
}

}  // namespace graticule::html
