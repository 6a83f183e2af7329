#include "kluft/core/task_tree.hpp"

#include <algorithm>
#include <csignal>
#include <system_error>
#include <thread>
#include <utility>

namespace kluft {

namespace {

/// Signals are for the threads of the program: those started while this exists do not take them.
class SignalsBlocked {
public:
    SignalsBlocked() {
        sigset_t all;
        sigfillset(&all);
        pthread_sigmask(SIG_SETMASK, &all, &before_);
    }
    ~SignalsBlocked() { pthread_sigmask(SIG_SETMASK, &before_, nullptr); }
    SignalsBlocked(const SignalsBlocked&) = delete;
    SignalsBlocked& operator=(const SignalsBlocked&) = delete;

private:
    sigset_t before_{};
};

} // namespace

TaskTree::TaskTree(std::vector<int> parent) : parent_(std::move(parent)), waiting_for_(parent_.size(), 0) {
    for (const int p : parent_) {
        if (p >= 0) ++waiting_for_[p];
    }
    for (int i = 0; i < static_cast<int>(parent_.size()); ++i) {
        if (waiting_for_[i] == 0) ready_.push(i);
    }
    n_open_ = static_cast<int>(parent_.size());
}

void TaskTree::run(int n_threads, const Task& task) {
    n_threads_ = std::max(n_threads, 1);
    std::vector<std::thread> others;
    others.reserve(n_threads_ - 1);
    {
        const SignalsBlocked blocked;
        try {
            for (int t = 1; t < n_threads_; ++t) others.emplace_back([this, t, &task] { work(t, task); });
        } catch (const std::system_error&) { // those that there are do all
        }
    }
    work(0, task);
    for (std::thread& other : others) other.join();
    if (error_) std::rethrow_exception(error_);
}

void TaskTree::work(int thread, const Task& task) {
    Lock lock(mutex_);
    while (n_open_ > 0) {
        if (!ready_.empty()) {
            const int number = ready_.top();
            ready_.pop();
            do_task(number, thread, task, lock);
        } else if (Loop* const loop = open_loop()) {
            take_part(*loop, lock);
        } else {
            changed_.wait(lock);
        }
    }
}

void TaskTree::do_task(int number, int thread, const Task& task, Lock& lock) {
    lock.unlock();
    std::exception_ptr error;
    try {
        task(number, thread);
    } catch (...) {
        error = std::current_exception();
    }
    lock.lock();
    if (error && !error_) error_ = error;
    if (error || n_open_ == 0) { // or another one has stopped the work
        n_open_ = 0;
        changed_.notify_all();
        return;
    }
    --n_open_;
    const int parent = parent_[number];
    if (parent >= 0 && --waiting_for_[parent] == 0) ready_.push(parent);
    if (n_threads_ > 1) changed_.notify_all();
}

TaskTree::Loop* TaskTree::open_loop() {
    const auto found = std::ranges::find_if(loops_, [](const Loop* loop) { return loop->next < loop->n; });
    return found != loops_.end() ? *found : nullptr;
}

/// Takes one i after the other until none is left to take.
void TaskTree::take_part(Loop& loop, Lock& lock) {
    while (loop.next < loop.n) {
        const int i = loop.next++;
        lock.unlock();
        (*loop.body)(i);
        lock.lock();
        if (++loop.done == loop.n) changed_.notify_all();
    }
}

void TaskTree::share(int n, const Body& body) {
    if (n_threads_ == 1 || n <= 1) {
        for (int i = 0; i < n; ++i) body(i);
        return;
    }
    Loop loop{.body = &body, .n = n};
    Lock lock(mutex_);
    loops_.push_back(&loop);
    changed_.notify_all();
    take_part(loop, lock);
    changed_.wait(lock, [&] { return loop.done == loop.n; });
    loops_.erase(std::ranges::find(loops_, &loop));
}

void TaskTree::stop() {
    const Lock lock(mutex_);
    n_open_ = 0;
    changed_.notify_all();
}

} // namespace kluft
