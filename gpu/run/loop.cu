/* SPDX-License-Identifier: Apache-2.0 */
/* Launches as CUDA graphs, loops on the device with a WHILE node.
 * gpu/run/loop.cuh */
#include "gpu/run/reel.cuh"

/* Graphs that are kept, and launches after which one that was not among them
 * may go. */
enum { LOOPS = 64, LOOP_IDLE = 4096 };

/* A graph, and what it was captured with; its key lies behind it. */
struct kept {
    struct kept *next;
    cudaGraphExec_t graph;
    size_t n;
    int block, ranks;
    int64_t used; /* the last launch, by number */
    int status;   /* of what was queued */
};

struct gpu_loops {
    cudaStream_t stream; /* to capture in; the caller's may not allow it */
    struct kept *first;
    int count;
    bool absent; /* the device has none */
    int64_t launches;
};

#if CUDART_VERSION >= 12030

static __global__ void loop_kernel(cudaGraphConditionalHandle handle,
                                   const int32_t *again)
{
    cudaGraphSetConditional(handle, *again != 0);
}

cudaError_t gpu_conditional(cudaGraph_t graph,
                            enum cudaGraphConditionalNodeType type,
                            unsigned first, struct conditional *c)
{
    cudaGraphNodeParams p = {};
    cudaError_t error = cudaGraphConditionalHandleCreate(
        &c->handle, graph, first, cudaGraphCondAssignDefault);
    if (error != cudaSuccess)
        return error;
    p.type = cudaGraphNodeTypeConditional;
    p.conditional.handle = c->handle;
    p.conditional.type = type;
    p.conditional.size = 1;
#if CUDART_VERSION >= 13000
    error = cudaGraphAddNode(&c->node, graph, NULL, NULL, 0, &p);
#else
    error = cudaGraphAddNode(&c->node, graph, NULL, 0, &p);
#endif
    if (error == cudaSuccess)
        c->body = p.conditional.phGraph_out[0];
    return error;
}

/* What the turn queues becomes the graph, whose failure is not the device's. */
static cudaError_t capture(struct gpu *g, cudaGraph_t graph, loop_turn turn,
                           int *status)
{
    cudaStream_t stream = g->loops->stream, callers = g->stream;
    enum tape_mode tape = g->tape;
    size_t n = strlen(g->name);
    cudaError_t error = cudaStreamBeginCaptureToGraph(
        stream, graph, NULL, NULL, 0, cudaStreamCaptureModeRelaxed);
    if (error != cudaSuccess)
        return error;
    g->stream = stream;
    g->tape = TAPE_OFF;
    *status = turn.run(turn.with);
    g->tape = tape;
    g->stream = callers;
    error = cudaStreamEndCapture(stream, &graph);
    if (g->failed) {
        *status = g->failed = DRAPE_OK;
        g->name[n] = 0;
        return cudaErrorUnknown;
    }
    return *status == DRAPE_OK ? error : cudaErrorInvalidValue;
}

void gpu_loop_ask(cudaStream_t stream, cudaGraphConditionalHandle handle,
                  const int32_t *again)
{
    loop_kernel<<<1, 1, 0, stream>>>(handle, again);
}

cudaError_t gpu_loop_body(struct gpu *g, const struct conditional *c,
                          const int32_t *again, loop_turn turn, int *status)
{
    auto whole = [&] {
        int done = turn.run(turn.with);
        gpu_loop_ask(g->stream, c->handle, again);
        return done;
    };
    return capture(g, c->body, whole, status);
}

static cudaError_t capture_loop(struct gpu *g, cudaGraph_t graph,
                                const int32_t *again, loop_turn turn,
                                int *status)
{
    struct conditional c;
    cudaError_t error = gpu_conditional(graph, cudaGraphCondTypeWhile, 1, &c);
    return error == cudaSuccess ? gpu_loop_body(g, &c, again, turn, status)
                                : error;
}

/* Writes graph and status of k. */
static cudaError_t build(struct gpu *g, struct kept *k, const int32_t *again,
                         loop_turn turn)
{
    cudaGraph_t graph;
    cudaError_t error = cudaGraphCreate(&graph, 0);
    if (error != cudaSuccess)
        return error;
    error = again ? capture_loop(g, graph, again, turn, &k->status)
                  : capture(g, graph, turn, &k->status);
    if (error == cudaSuccess)
        error = cudaGraphInstantiate(&k->graph, graph, 0);
    cudaGraphDestroy(graph);
    return error;
}

#else

static cudaError_t build(struct gpu *, struct kept *, const int32_t *,
                         loop_turn)
{
    return cudaErrorNotSupported;
}

#endif

static bool same(const struct kept *k, const struct gpu *g, struct loop_key key)
{
    return k->block == g->block && k->ranks == g->ranks && k->n == key.n &&
           !memcmp(k + 1, key.bytes, key.n);
}

/* Makes room among those that are kept: false if all are in use. */
static bool make_room(struct gpu *g)
{
    struct gpu_loops *l = g->loops;
    struct kept **oldest = &l->first;
    if (l->count < LOOPS)
        return true;
    for (struct kept **at = &l->first; *at; at = &(*at)->next)
        if ((*at)->used < (*oldest)->used)
            oldest = at;
    struct kept *k = *oldest;
    if (k->used + LOOP_IDLE > l->launches)
        return false;
    *oldest = k->next;
    gpu_wait(g);
    cudaGraphExecDestroy(k->graph);
    arena_give(&g->host, k);
    l->count--;
    return true;
}

/* A new one, NULL if there is none. */
static struct kept *make(struct gpu *g, struct loop_key key,
                         const int32_t *again, loop_turn turn)
{
    struct gpu_loops *l = g->loops;
    struct kept *k = NULL;
    if (make_room(g))
        k = (struct kept *)arena_take(&g->host, ARENA_OTHER,
                                      (int64_t)(sizeof *k + key.n), 1);
    if (!k)
        return NULL;
    cudaError_t error = build(g, k, again, turn);
    if (error != cudaSuccess) {
        cudaGetLastError(); /* it is an answer */
        l->absent = k->status == DRAPE_OK && error != cudaErrorMemoryAllocation;
        arena_give(&g->host, k);
        return NULL;
    }
    k->n = key.n;
    k->block = g->block;
    k->ranks = g->ranks;
    memcpy(k + 1, key.bytes, key.n);
    k->next = l->first;
    l->first = k;
    l->count++;
    return k;
}

bool gpu_loops_open(struct gpu *g)
{
    if (!g->loops)
        g->loops = (struct gpu_loops *)arena_take(&g->host, ARENA_OTHER, 1,
                                                  sizeof *g->loops);
    if (!g->loops || g->loops->absent)
        return false;
    if (!g->loops->stream)
        gpu_note(g, cudaStreamCreateWithFlags(&g->loops->stream,
                                              cudaStreamNonBlocking));
    return !g->failed;
}

/* Queues it by a graph that is kept. */
static bool queue(struct gpu *g, struct loop_key key, const int32_t *again,
                  loop_turn turn)
{
    if (g->hosted[0] || g->hosted[1] || g->failed || !gpu_loops_open(g))
        return false;
    struct kept *k = g->loops->first;
    while (k && !same(k, g, key))
        k = k->next;
    if (!k)
        k = make(g, key, again, turn);
    if (!k)
        return false;
    k->used = ++g->loops->launches;
    gpu_note(g, cudaGraphLaunch(k->graph, g->stream));
    return true;
}

bool gpu_loop(struct gpu *g, struct loop_key key, const int32_t *again,
              loop_turn turn)
{
    int queues = gpu_queues(g, (const void *)gpu_loop);
    if (queues == 0) /* a tape has done it */
        return !g->failed;
    if (!queue(g, key, again, turn)) {
        gpu_tape_spoil(g);
        return false;
    }
    if (queues > 1)
        reel_record_loop(g, again, turn);
    return true;
}

void gpu_loops_close(struct gpu *g)
{
    if (!g->loops)
        return;
    for (struct kept *k = g->loops->first; k; k = k->next)
        cudaGraphExecDestroy(k->graph);
    if (g->loops->stream)
        cudaStreamDestroy(g->loops->stream);
}
