// The frame and the style of a page.
#include "report/page.hpp"

#include <fmt/format.h>

#include "report/chart.hpp"
#include "report/style.hpp"

namespace dartcast {

std::string page_html(const Page& page) {
  std::string scripts;
  for (const std::string& s : page.scripts) scripts += s;
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'{}; "
      "style-src 'unsafe-inline'; img-src data: blob:\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<meta name=\"generator\" content=\"dartcast {}\">\n"
      "<title>{}</title>\n<style>{}</style>\n</head>\n<body>\n<header><h1>{}</h1><p "
      "id=\"caption\">{}</p></header>\n<main>\n{}</"
      "main>\n"
      "{}</body>\n</html>\n",
      page.runs_engine ? " 'wasm-unsafe-eval' blob:; worker-src blob:" : "", DARTCAST_VERSION, html(page.title),
      page_style, html(page.title), html(page.subtitle), page.body, scripts);
}

}  // namespace dartcast
