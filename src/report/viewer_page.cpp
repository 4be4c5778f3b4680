// Puts the viewer, its data and a body together.
#include "report/viewer_page.hpp"

#include <fmt/format.h>

#include "report/chart.hpp"
#include "report/page.hpp"

namespace dartcast {

// JSON in an element of a script: "<" could end it.
std::string json_script(const std::string& json) {
  std::string out = "<script type=\"application/json\" id=\"meta\">";
  out.reserve(json.size() + 64);
  for (const char c : json) {
    if (c == '<')
      out += "\\u003c";
    else
      out += c;
  }
  return out + "</script>\n";
}

std::string viewer_page(const ViewerPage& page, const ViewerData& data) {
  Page whole;
  whole.title = page.title;
  whole.subtitle = page.subtitle;
  whole.body =
      "<section id=\"view\" aria-label=\"The scene in 3D\">" + data.picture +
      "<p class=\"fallback\">This is a still picture: the scene in 3D needs JavaScript and WebGL.</p></section>\n";
  for (const std::string& note : data.taken.notes) whole.body += "<p class=\"notes\">" + html(note) + "</p>\n";
  whole.body += page.body;
  whole.scripts.push_back(json_script(data.description));
  for (std::size_t i = 0; i < data.blocks.size(); ++i)
    whole.scripts.push_back(fmt::format("<script type=\"text/plain\" id=\"b{}\">{}</script>\n", i, data.blocks[i]));
  whole.scripts.push_back(fmt::format("<script type=\"module\">{}</script>\n", viewer_program()));
  return page_html(whole);
}

}  // namespace dartcast
