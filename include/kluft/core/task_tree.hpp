// Tasks along the branches of trees, done by several threads.
#pragma once

#include <condition_variable>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <queue>
#include <vector>

namespace kluft {

/// A task is done after its children. A thread takes the ready task with the least number; one that finds none ready takes
/// part in the loops of the others. What a task computes must not depend on the thread that does it.
class TaskTree {
public:
    using Task = std::function<void(int task, int thread)>; ///< threads are numbered from zero
    using Body = std::function<void(int i)>;

    /// parent[i] > i, or -1 at a root.
    explicit TaskTree(std::vector<int> parent);

    /// Does all tasks, with the thread that calls and up to n_threads - 1 more (fewer where the system refuses them).
    /// Throws what a task has thrown; the tasks that had not begun by then are not done.
    void run(int n_threads, const Task& task);

    /// body(i) for all i < n, in any order and by any thread; to be called by a task. The body must not throw.
    void share(int n, const Body& body);

    /// Tasks that have not begun are not done: to be called by a task that has found that all is in vain.
    void stop();

private:
    struct Loop {
        const Body* body = nullptr;
        int n = 0;
        int next = 0; ///< first i that nobody has taken
        int done = 0;
    };
    using Lock = std::unique_lock<std::mutex>;

    void work(int thread, const Task& task);
    void do_task(int number, int thread, const Task& task, Lock& lock);
    void take_part(Loop& loop, Lock& lock);
    [[nodiscard]] Loop* open_loop();

    std::vector<int> parent_;
    std::vector<int> waiting_for_; ///< children that are not done
    std::priority_queue<int, std::vector<int>, std::greater<>> ready_;
    std::deque<Loop*> loops_;
    int n_open_ = 0; ///< tasks that are not done
    int n_threads_ = 1;
    std::exception_ptr error_;
    std::mutex mutex_;
    std::condition_variable changed_;
};

} // namespace kluft
