// One self-contained HTML page in the style of all reports. Not installed.
#pragma once

#include <string>
#include <vector>

namespace dartcast {

struct Page {
  std::string title;                 ///< plain text
  std::string subtitle;              ///< plain text
  std::string body;                  ///< HTML
  std::vector<std::string> scripts;  ///< elements of scripts and data at the end, whole
  bool runs_engine = false;          ///< the policy lets scripts make WebAssembly and workers
};

/// The page's content security policy allows no request. Light and dark follow the system.
std::string page_html(const Page& page);

/// The viewer's program (viewer/viewer.min.js), as the library holds it.
std::string viewer_program();

}  // namespace dartcast
