// Results that ranks have each for their own particles, as one list by id. Not installed.
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "base/are_several.hpp"
#include "base/bytes.hpp"
#include "dartcast/ranks.hpp"

namespace dartcast {

class ParticleSystem;
class StatisticsComponent;

/// The entries of all lists, by id. Entries of one id are of one list, and keep their order.
template <class T>
std::vector<T> merged_by_id(const std::vector<std::vector<T>>& lists) {
  std::vector<T> all;
  for (const std::vector<T>& list : lists) all.insert(all.end(), list.begin(), list.end());
  std::stable_sort(all.begin(), all.end(), [](const T& a, const T& b) { return a.id < b.id; });
  return all;
}

/// The first rank gets the entries of all ranks, by id; the others keep their own. Collective.
template <class T>
std::vector<T> gathered_by_id(Ranks* ranks, std::vector<T> own) {
  if (!are_several(ranks)) return own;
  ByteWriter bytes;
  bytes.put(own);
  const std::vector<std::string> all = ranks->gather(bytes.bytes());
  if (ranks->rank() != 0) return own;
  std::vector<std::vector<T>> lists;
  for (const std::string& b : all) lists.push_back(ByteReader(b).take_list<T>());
  return merged_by_id(lists);
}

/// The first rank's last step, and what its statistics have found, become those of all ranks. Collective.
void gather_step(Ranks& ranks, ParticleSystem& particles, StatisticsComponent& statistics, bool with_contacts);

}  // namespace dartcast
