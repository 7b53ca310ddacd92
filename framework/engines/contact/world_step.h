/// One step of a world, the same for every engine: free paths, persistent contacts, the first
/// impact, commit, position correction; and the response to an impact.
///
/// rd (rd/retroactive.h) takes it with all bodies of a scene, and adds sleep, pictures and
/// callbacks. A logical process (events/process_world.h) takes it with its own bodies, and adds
/// loading and saving of its state.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "framework/engines/contact/persistent_contacts.h"
#include "framework/engines/contact/impact_detection.h"
#include "framework/engines/contact/sequential_impacts.h"

namespace tumble::engines {

/// What a scene says about steps and impacts, and an engine about where it looks for them.
struct StepRules {
  double step;                   // [s]
  double restitution_threshold;  // restitution threshold [m/s]
  // false: where a scene asks for no contacts, impacts are found elsewhere
  bool searches_without_contacts = true;
};

/// What an engine adds to a step.
class StepStages {
 public:
  virtual ~StepStages() = default;
  /// Begins a step, which gives every body the path that it would take without the others.
  virtual void begin(double target) = 0;
  /// Begins it again: with an earlier target, or with the same after impulses at its start.
  /// @return false: the step ends where it began
  virtual bool begin_again(double target) = 0;
  /// Wakes bodies that something moving comes near to.
  /// @return whether any: the step is then begun again
  virtual bool wake_approached(const std::vector<ImpactDetection::Pair>&) { return false; }
  /// Wakes the bodies of a pair. @return whether one slept
  virtual bool wake(ImpactDetection::Pair) { return false; }
  /// All paths are known, up to `reached`, where the world goes next.
  virtual void before_commit(double) {}
  /// An impulse of respond(). Impacts within persistent contacts go to the sink alone.
  virtual void impact(const Event& event) = 0;
};

class WorldStep {
 public:
  using Pair = ImpactDetection::Pair;  // bodies, first < second

  /// @param sink    gets the events of contacts, and of balls that come to rest
  /// @param shapes  by body, prepared before; empty: made from the world
  WorldStep(World world, const Laws& laws, StepRules rules, RunCounters& counters,
            TrajectorySink& sink, const std::vector<const collision::CollisionShape*>& shapes = {});
  WorldStep(const WorldStep&) = delete;
  WorldStep& operator=(const WorldStep&) = delete;

  /// What became of a step.
  struct Taken {
    enum class How {
      kCommitted,
      kGivenUp,       // a sleeper is awake now: it is to be begun again
      kEndedAtStart,  // StepStages::begin_again has said so
    };
    How how = How::kCommitted;
    std::vector<Pair> searched;  // pairs that were searched for their first impact
    // all that may meet on the paths that contacts have given; empty where nothing is in contact
    std::vector<Pair> near;
    std::optional<Pair> impact;  // which ends the step; respond() is what follows
    /// Pairs that may take part in that impact.
    const std::vector<Pair>& around() const { return near.empty() ? searched : near; }
  };
  /// Takes the world towards `target`: to there, to the first impact before it, or to an earlier
  /// time that bodies which turn far, or contacts, ask for (moving().time() says which). Call it
  /// again until the target is reached.
  /// @throws StoppedRun where a state is not a number afterwards
  Taken take(double target, StepStages& stages);

  /// Velocities jump, by the laws' impulses, at everything that touches at the committed time; slow
  /// contacts begin to persist.
  /// @param pairs      sorted; the trigger is among them
  /// @param is_in_step whether a step has just ended here, so that the contacts it kept apart are
  /// those that touch
  /// @throws StoppedRun where bodies still approach however often impulses act
  void respond(const std::vector<Pair>& pairs, Pair trigger, bool is_in_step, StepStages& stages);

  void require_numbers() const;
  std::string name(int body) const {
    return "'" + moving_.world().bodies[static_cast<std::size_t>(body)].name + "'";
  }
  std::string names(Pair pair) const {
    return "bodies " + name(pair.first) + " and " + name(pair.second);
  }

  MovingWorld& moving() { return moving_; }
  const MovingWorld& moving() const { return moving_; }
  ImpactDetection& impact_detection() { return impact_detection_; }
  const ImpactDetection& impact_detection() const { return impact_detection_; }
  SequentialImpacts& impacts() { return impacts_; }
  bool has_contacts() const { return built::kContact && contacts_.has_value(); }
  /// @pre has_contacts()
  PersistentContacts& contacts() { return *contacts_; }
  const PersistentContacts& contacts() const { return *contacts_; }

 private:
  struct TouchingPairs {
    std::vector<TouchingPair> all;  // sorted by (a, b)
    std::size_t trigger = 0;        // which of them stopped the step
  };

  double followed(double target);
  void choose_coordinates();
  std::vector<Pair> pairs_in_step();
  bool keep_contacts(Taken& taken, StepStages& stages);
  void remove_overlaps(const Taken& taken);
  Taken give_up();
  TouchingPairs touching_pairs(const std::vector<Pair>& pairs, Pair trigger, bool is_in_step);
  void choose_normal(Pair pair, collision::Gap& gap);
  void begin_slow_contacts(const TouchingPairs& touching, const std::vector<Event>& events);
  void bring_to_rest(const TouchingPairs& touching, const std::vector<Event>& events);
  void send_apart(const TouchingPairs& touching, const Resolution& resolution);

  const Laws& laws_;
  StepRules rules_;
  RunCounters& counters_;
  TrajectorySink& sink_;
  MovingWorld moving_;
  ImpactDetection impact_detection_;
  SequentialImpacts impacts_;
  std::optional<PersistentContacts> contacts_;  // where the scene asks for them
  bool searches_;                               // whether impacts are looked for here
};

}  // namespace tumble::engines
