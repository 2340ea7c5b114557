// SPDX-License-Identifier: BSD-3-Clause
#include "rank_steps.h"

#include <chrono>
#include <stdexcept>
#include <utility>

#include "counted.h"
#include "fcl/ccd_version.h"
#include "json.h"
#include "run_command.h"

namespace fcl_ccd {
namespace {

/// How long a rank waits for a step of its own before it looks for signals and messages.
constexpr std::chrono::milliseconds kGlance(20);

std::string bytesOf(const Json& message) {
  std::string bytes;
  Json::to_cbor(message, bytes);
  return bytes;
}

constexpr const char* kOwnStep = "this rank's step did not end";

/// Why a run cannot begin on another rank; empty if it can.
std::string hindrance(const Json& other, const Readiness& own) {
  if (other.at("version") != FCL_CCD_VERSION)
    return "another version of fcl-ccd than on rank 0";
  if (other.at("command") != own.command) return "another command line than on rank 0";
  if (other.at("cause") != "") return other.at("cause");
  if (other.at("num_steps") != own.num_steps)
    return counted(other.at("num_steps"), "step") + ", but " +
           std::to_string(own.num_steps) +
           " on rank 0. All ranks need the same files. "
           "If more frames are still to come, name the last one with --end";
  return "";
}

StepOutcome nextOwn(Ranks& ranks, OwnSteps& own) {
  while (true) {
    if (std::optional<StepOutcome> outcome = own.next(kGlance))
      return *std::move(outcome);
    ranks.requirePatience(kOwnStep);
  }
}

}  // namespace

StepRange RankGatherer::begin(
    const Readiness& own,
    const std::function<std::size_t(const Readiness&)>& firstStepOf) {
  ranks_.beginExchange();
  Readiness all = own;
  std::string cause;
  for (int rank = 1; rank < ranks_.size(); ++rank) {
    const Json other = Json::from_cbor(ranks_.receive(rank));
    if (!cause.empty()) continue;
    cause = hindrance(other, own);
    const std::string name = other.at("name").get<std::string>() + ": ";
    if (!cause.empty()) cause.insert(0, name);
    const std::size_t num_whole = other.at("num_whole_steps");
    if (num_whole >= all.num_whole_steps) continue;
    all.num_whole_steps = num_whole;
    all.unfinished = name + other.at("unfinished").get<std::string>();
  }
  StepRange range{0, all.num_whole_steps};
  if (cause.empty()) {
    try {
      range.first = firstStepOf(all);
    } catch (const std::exception& error) {
      cause = error.what();
    }
  }
  ranks_.post(cause.empty() ? bytesOf(Json::array({range.first, range.end})) : "");
  if (cause.empty()) return range;
  ranks_.endExchange();
  throw std::runtime_error(cause);
}

void RankGatherer::refuse() {
  ranks_.beginExchange();
  for (int rank = 1; rank < ranks_.size(); ++rank) ranks_.receive(rank);
  ranks_.post("");
  ranks_.endExchange();
}

StepOutcome RankGatherer::take(
    OwnSteps& own, const StepShare& share,
    const std::function<void(std::size_t, const StepRecord&)>& take) {
  for (std::size_t step = share.first; step < share.end; ++step) {
    const std::size_t rank = share.rankOf(step);
    StepOutcome outcome = rank == 0 ? nextOwn(ranks_, own)
                                    : outcomeOf(ranks_.receive(static_cast<int>(rank)));
    if (!outcome.record) {
      has_ended_[rank] = true;
      return outcome;
    }
    take(step, *outcome.record);
  }
  return {};
}

void RankGatherer::end(OwnSteps& own) {
  own.stop();
  ranks_.post("");
  for (int rank = 1; rank < ranks_.size(); ++rank) {
    auto&& has_ended = has_ended_[static_cast<std::size_t>(rank)];
    while (!has_ended) has_ended = !outcomeOf(ranks_.receive(rank)).record;
  }
  ranks_.endExchange();
}

std::optional<StepRange> awaitBegin(Ranks& ranks, const Readiness& own) {
  ranks.beginExchange();
  ranks.send(0, bytesOf({{"name", ranks.name()},
                         {"version", FCL_CCD_VERSION},
                         {"command", own.command},
                         {"num_steps", own.num_steps},
                         {"num_whole_steps", own.num_whole_steps},
                         {"unfinished", own.unfinished},
                         {"cause", own.cause}}));
  const std::string answer = ranks.receive(0);
  if (!answer.empty()) {
    const Json range = Json::from_cbor(answer);
    return StepRange{range.at(0), range.at(1)};
  }
  ranks.endExchange();
  return std::nullopt;
}

void sendSteps(Ranks& ranks, OwnSteps& own) {
  const auto sendEnd = [&ranks](StepOutcome end) {
    if (!end.cause.empty()) end.cause = ranks.name() + ": " + end.cause;
    ranks.send(0, toBytes(end));
  };
  try {
    while (true) {
      if (ranks.hasMessage(0)) own.stop();
      const std::optional<StepOutcome> outcome = own.next(kGlance);
      if (!outcome) {
        ranks.requirePatience(kOwnStep);
        continue;
      }
      if (!outcome->record) {
        sendEnd(*outcome);
        break;
      }
      ranks.send(0, toBytes(*outcome));
    }
  } catch (const RankLost&) {
    throw;
  } catch (const std::exception& error) {  // a record that is too large to send
    sendEnd({std::nullopt, kBadFrame, error.what()});
  }
  ranks.receive(0);
  ranks.endExchange();
}

}  // namespace fcl_ccd
