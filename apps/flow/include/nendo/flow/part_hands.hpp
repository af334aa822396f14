#pragma once
// Hands that take parts of a model, move, turn and put them down, with the interface that a
// Sculptor needs.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <nendo/deform/clay.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/part_mover.hpp>
#include <nendo/flow/hand_contact.hpp>

namespace nendo::flow {

/// The parts that hands hold in a frame.
struct PartsState {
  std::uint32_t count = 0; ///< the number of parts; 0: another mode is in effect
  /// The part that each hand holds, of the hands that are present, left hand first; none: no_index.
  std::array<std::uint32_t, 2> held{deform::no_index, deform::no_index};
  /// The part that a hand has taken last; no_index if none has taken any of this model's.
  std::uint32_t chosen = deform::no_index;

  bool is_held() const noexcept {
    return held[0] != deform::no_index || held[1] != deform::no_index;
  }
};

/// Its functions do what those of deform::PartMover do, for hands whose fingertips are at `tips`,
/// five columns per hand, model units. A hand is closed if its thumb has met the index or the
/// middle finger, until these are farther apart again. A part turns with the palm, and goes with
/// the middle between thumb and fingers. None but the constructor allocates.
class NENDO_API PartHands {
public:
  static constexpr double closed_m = 0.025; ///< from tip to tip
  static constexpr double open_m = 0.040;
  static constexpr double reach_m = 0.040; ///< from between the tips to a vertex

  /// `shape` must outlive this. Parts with a protected vertex in `mask` stay.
  PartHands(deform::SculptedShape& shape, std::shared_ptr<const deform::ModelParts> parts,
            std::shared_ptr<const HandBodies> bodies,
            std::shared_ptr<const deform::VertexMask> mask);

  deform::FieldStatus begin(const deform::Points& tips) { return mover_.begin(grips(tips)); }
  deform::FieldStatus grab(const deform::Points& tips) { return mover_.grab(grips(tips)); }
  /// Moves what is held to where the hands are, always the whole path.
  deform::FieldStatus follow(const deform::Points& tips, bool ends) noexcept;
  void release(bool is_step) noexcept;
  deform::FieldStatus go(deform::HistoryMove move, const deform::Points& tips) {
    return mover_.go(move, grips(tips));
  }

  /// Always empty: a part moves as a whole, and others stay.
  const deform::FieldSequence& fields() const noexcept { return fields_; }
  deform::ChainReport report() const noexcept { return {}; }
  bool is_moved() const noexcept { return mover_.is_moved(); } ///< in the last follow()
  PartsState state() const noexcept;
  /// Returns where hands hold parts, as if these were clay that they touch lightly.
  std::span<const deform::ClayContact> contacts() const noexcept { return contacts_; }

private:
  static constexpr std::size_t max_places = 24; ///< the limit of a hand's contacts

  struct Hand {
    bool is_closed = false;
    std::uint32_t held = deform::no_index; ///< the part of these places
    std::vector<std::size_t> places{};     ///< in block order
  };

  std::span<const deform::PartGrip> grips(const deform::Points& tips) noexcept;
  void find_places(std::size_t hand) noexcept;
  void update_contacts() noexcept;

  std::shared_ptr<const deform::ModelParts> parts_;
  std::shared_ptr<const HandBodies> bodies_;
  std::vector<Hand> hands_;
  std::uint32_t chosen_ = deform::no_index;
  std::vector<deform::PartGrip> grips_;
  std::vector<deform::ClayContact> contacts_;
  deform::PartMover mover_;
  deform::FieldSequence fields_;
};

} // namespace nendo::flow
