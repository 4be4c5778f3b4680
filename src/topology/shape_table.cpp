// The table of shapes: equal cells share one, and unused ones are released.
#include <algorithm>
#include <utility>

#include "dartcast/error.hpp"
#include "dartcast/storage.hpp"

namespace dartcast {

std::size_t ShapeTable::KeyHash::operator()(const ShapeKey* key) const {
  std::uint64_t hash = (std::uint64_t{key->corner_count} << 32U) | (std::uint64_t{key->apex} << 1U) | key->has_point;
  const auto take = [&](std::uint64_t word) { hash = (hash ^ word) * 0x9e3779b97f4a7c15U, hash ^= hash >> 29U; };
  for (const auto& face : key->faces) {
    take((face.corners.size() << 1U) | face.has_point);
    for (const std::uint16_t corner : face.corners) take(corner);
  }
  return static_cast<std::size_t>(hash);
}

ShapeTable::Interned ShapeTable::intern(const ShapeKey& key) {
  const auto found = numbers_.find(&key);
  if (found != numbers_.end()) {
    if (uses_[found->second] != forever) ++uses_[found->second];
    return {found->second, false, false};
  }
  auto shape = make(key);
  auto number = static_cast<std::uint32_t>(vacant_.empty() ? shapes_.size() : vacant_.back());
  if (vacant_.empty() && number >= kept_begin && number < kept_end) number = kept_end;
  if (!vacant_.empty()) vacant_.pop_back();
  const Interned interned = put(number, std::move(shape), 1);
  numbers_.emplace(&shapes_[number]->key(), number);
  return interned;
}

std::shared_ptr<const Shape>& ShapeTable::recent(const ShapeKey& key) {
  return recent_[KeyHash{}(&key) % recent_places];
}

std::shared_ptr<const Shape> ShapeTable::make(const ShapeKey& key) {
  if (!recent_.empty()) {
    std::shared_ptr<const Shape>& known = recent(key);
    if (known && known->key() == key) return std::exchange(known, nullptr);
  }
  return std::make_shared<const Shape>(key);
}

ShapeTable::Interned ShapeTable::add_standard(std::uint32_t signature, ShapeKey key) {
  auto shape = std::make_shared<const Shape>(std::move(key));
  auto number = static_cast<std::uint32_t>(shapes_.size());
  for (std::uint32_t n = kept_begin; number >= kept_end && n < kept_end; ++n) {
    if (!shapes_[n]) number = n;
  }
  if (number >= kept_end) throw InternalError("the numbers kept for standard shapes don't suffice");
  const Interned interned = put(number, std::move(shape), forever);
  numbers_.try_emplace(&shapes_[number]->key(), number);
  standard_.emplace(signature, number);
  return interned;
}

ShapeTable::Interned ShapeTable::put(std::uint32_t number, std::shared_ptr<const Shape> shape, std::uint32_t uses) {
  const bool appended = number >= shapes_.size();
  if (appended) {
    shapes_.resize(number + std::size_t{1});
    uses_.resize(number + std::size_t{1});
  }
  shapes_[number] = std::move(shape);
  uses_[number] = uses;
  ++count_;
  return {number, true, appended};
}

void ShapeTable::drop(std::uint32_t number) {
  const auto known = numbers_.find(&shapes_[number]->key());
  if (known != numbers_.end() && known->second == number) numbers_.erase(known);
  if (shapes_[number]->dart_count() <= max_recent_darts) {
    recent_.resize(recent_places);
    recent(shapes_[number]->key()) = shapes_[number];
  }
  shapes_[number].reset();
  uses_[number] = 0;
  --count_;
}

void ShapeTable::release(std::uint32_t number) {
  if (uses_[number] == forever || --uses_[number] > 0) return;
  drop(number);
  vacant_.push_back(number);
}

void ShapeTable::undo(const Interned& interned) {
  const std::uint32_t number = interned.number;
  const bool standard = uses_[number] == forever;
  if (!interned.made) {
    if (!standard) --uses_[number];
    return;
  }
  if (standard) std::erase_if(standard_, [&](const auto& entry) { return entry.second == number; });
  drop(number);
  if (interned.appended) {
    // The first one behind the numbers kept for standard shapes has made places for those, too.
    do {
      shapes_.pop_back();
      uses_.pop_back();
    } while (number == kept_end && shapes_.size() > kept_begin && !shapes_.back());
  } else if (!standard) {
    vacant_.push_back(number);
  }
}

std::size_t ShapeTable::bytes() const {
  std::size_t sum = 0;
  for (const auto* shapes : {&shapes_, &recent_}) {
    for (const auto& s : *shapes) sum += s ? s->bytes() : 0;
  }
  return sum;
}

bool ShapeTable::operator==(const ShapeTable& other) const {
  const auto same = [](const auto& a, const auto& b) { return a == b || (a && b && a->key() == b->key()); };
  return uses_ == other.uses_ && vacant_ == other.vacant_ && numbers_.size() == other.numbers_.size() &&
         standard_ == other.standard_ &&
         std::equal(shapes_.begin(), shapes_.end(), other.shapes_.begin(), other.shapes_.end(), same);
}

}  // namespace dartcast
