// Cuts a face of a draft in two.
#include "topology/draft_cuts.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "dartcast/error.hpp"

namespace dartcast::detail {

void cut_face(CellDraft& draft, std::uint16_t face, Vertex u, Vertex v) {
  if (draft.faces.size() >= 0xffffU)
    throw EditRefused("cell " + std::to_string(draft.source) +
                      " would have more than 65535 faces on the way: cut it in several edits");
  DraftFace& first = draft.faces[face];
  std::vector<DraftCorner> all = std::move(first.corners);
  const auto is = [](Vertex w) { return [w](const DraftCorner& c) { return c.vertex == w; }; };
  std::rotate(all.begin(), std::find_if(all.begin(), all.end(), is(u)), all.end());
  const auto middle = std::find_if(all.begin(), all.end(), is(v));
  DraftFace rest;
  rest.patch = first.patch;
  rest.corners.reserve(all.size());
  rest.corners.assign(middle, all.end());
  rest.corners.front().straight = false;
  rest.corners.push_back({u, false, true});
  first.corners = std::move(all);
  first.corners.erase(middle, first.corners.end());
  first.corners.front().straight = false;
  first.corners.push_back({v, false, true});
  first.point = {};
  draft.faces.push_back(std::move(rest));
}

}  // namespace dartcast::detail
