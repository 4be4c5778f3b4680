// The answers to contacts in calls from Python: nothing, a response, responses by patch, or a function.
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "dartcast/combinatorial_map.hpp"
#include "dartcast/contact.hpp"
#include "dartcast/response.hpp"
#include "support/typed.hpp"

namespace dartcast::python {

/// A WallResponse, or a Reflect, Slide, Stick, Absorb or Escape. False if the object is none of these.
bool load_response(pybind11::handle from, WallResponse& response);

/// WallResponses, or what they are made from: one response, or a dict with patches by name or number, and the general
/// one at None. Throws TypeError for anything else, InvalidArgument for a name that is no patch of the map. `map`: null
/// if there is none, so that patches have numbers only.
WallResponses responses_of(const pybind11::object& given, const CombinatorialMap* map);

/// The answers of respond_with(), with all that they refer to. At one address for its life.
struct LibraryAnswers {
  WallResponses responses;
  pybind11::object velocities, statuses;  ///< arrays; kept
  std::vector<ParticleStatus> own;        ///< if the caller gives no statuses
  std::size_t size = 0;                   ///< number of particles
  ContactCallback callback;

  LibraryAnswers(WallResponses by, pybind11::object v, pybind11::object s, double dt, const Acceleration& acceleration);
  LibraryAnswers(const LibraryAnswers&) = delete;
  LibraryAnswers& operator=(const LibraryAnswers&) = delete;
  ~LibraryAnswers() = default;

  /// Throws InvalidArgument if there are not as many particles.
  void expect_particles(std::size_t count) const;
};

using RespondArgument = Typed<"Respond | None">;
using VelocitiesArgument = Typed<"Points | None">;
using StatusesArgument = Typed<"NDArray[uint8] | None">;
using TimeArgument = Typed<"float | None">;
using AccelerationArgument = Typed<"Acceleration | None">;
/// The arguments of a call that answer contacts.
struct RespondArguments {
  pybind11::object respond, velocities, statuses, dt, acceleration;
  bool per_contact = false;
};

/// The answers to the contacts of one call. At one address for its life.
class Answers {
 public:
  /// `count`: of particles. Throws TypeError and InvalidArgument if the arguments do not fit each other.
  Answers(const RespondArguments& given, const CombinatorialMap& map, std::size_t count);
  Answers(const Answers&) = delete;
  Answers& operator=(const Answers&) = delete;
  ~Answers() = default;

  /// Whether a function answers all contacts of a round at once.
  [[nodiscard]] bool in_rounds() const { return static_cast<bool>(round_); }
  [[nodiscard]] const RoundCallback& round() const { return round_; }
  /// Throws InvalidArgument for a function of rounds: `call` asks one contact at a time.
  [[nodiscard]] const ContactCallback& each(const char* call) const;

 private:
  std::shared_ptr<LibraryAnswers> library_;
  ContactCallback each_;
  RoundCallback round_;
};

/// Velocities and statuses as spans: uint8 (n,). Throws TypeError.
std::span<ParticleStatus> writable_statuses(const pybind11::object& x);
std::span<const ParticleStatus> statuses_of(const pybind11::object& x);

}  // namespace dartcast::python
