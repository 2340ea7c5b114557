// SPDX-License-Identifier: BSD-3-Clause
#ifndef FCL_CCD_RANKS_H
#define FCL_CCD_RANKS_H

#include <chrono>
#include <cstddef>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

namespace fcl_ccd {

/// @brief A rank died, or gives no answer after a signal asked this process to stop.
struct RankLost : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// @brief The processes that mpirun started for one run, and their messages. Without
/// mpirun there is one rank, and there are no messages. One object in a process; it is
/// for one thread.
///
/// Waiting uses little processor time. All functions that wait throw RankLost. mpirun
/// stops all ranks by a signal when one dies, and ends them a second later. So waiting
/// ends half a second after a signal.
class Ranks {
 public:
  /// @throws std::runtime_error if mpirun started several ranks and the program was built
  /// without MPI.
  Ranks();
  Ranks(const Ranks&) = delete;
  Ranks& operator=(const Ranks&) = delete;
  /// @brief Leaves MPI. If an exchange was begun and not ended, ends all ranks.
  ~Ranks();

  int size() const { return size_; }
  int rank() const { return rank_; }

  /// @brief "rank 2 on node7": this rank, for messages to the user.
  std::string name() const;

  /// @brief Between these two calls the other ranks rely on this one.
  void beginExchange() { in_exchange_ = true; }
  void endExchange();

  /// @brief Sends a message and waits until it is received.
  void send(int to, const std::string& bytes);

  /// @brief Sends a message to all other ranks and does not wait.
  void post(const std::string& bytes);

  /// @brief Whether a message can be received without waiting.
  bool hasMessage(int from);

  /// @brief The next message of a rank.
  std::string receive(int from);

  /// @brief For a caller that waits for something else: throws RankLost half a second
  /// after a signal.
  /// @param missing  what did not happen.
  void requirePatience(const std::string& missing);

 private:
  struct Messages;

  int size_{1};
  int rank_{0};
  bool in_exchange_{false};
  std::optional<std::chrono::steady_clock::time_point> stopped_at_;
  std::unique_ptr<Messages> messages_;  ///< null if this is the only rank
};

}  // namespace fcl_ccd

#endif
