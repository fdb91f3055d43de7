/* SPDX-License-Identifier: Apache-2.0 */
/* Captures and keeps CUDA graphs, with a WHILE node for loops. In a build
 * without CUDA gpu/run/emulate_threads.cpp takes its place. gpu/run/loop.cuh */
#include "gpu/run/loop.cuh"

/* At most LOOPS graphs are kept. The least recently used one may go when
 * LOOP_IDLE launches have passed since it was used. */
enum { LOOPS = 64, LOOP_IDLE = 4096 };

/* A graph that is kept. Its key follows it in memory. */
struct kept {
    struct kept *next;
    cudaGraphExec_t graph;
    size_t n;
    int block, ranks;
    int64_t used; /* number of its last launch */
    int status;   /* what the captured turn returned */
};

struct gpu_loops {
    cudaStream_t stream; /* for captures: the caller's may not allow them */
    struct kept *first;
    int count;
    bool absent; /* the device has no such graphs */
    int64_t launches;
};

#if CUDART_VERSION >= 12030

static __global__ void loop_kernel(cudaGraphConditionalHandle handle,
                                   const int32_t *again)
{
    cudaGraphSetConditional(handle, *again != 0);
}

/* Adds a WHILE node to the graph: its body, still empty, and the handle that
 * says whether the body runs once more, which each launch sets to true. */
static cudaError_t add_while(cudaGraph_t graph, cudaGraph_t *body,
                             cudaGraphConditionalHandle *handle)
{
    cudaGraphNodeParams p = {};
    cudaGraphNode_t node;
    cudaError_t error = cudaGraphConditionalHandleCreate(
        handle, graph, 1, cudaGraphCondAssignDefault);
    if (error != cudaSuccess)
        return error;
    p.type = cudaGraphNodeTypeConditional;
    p.conditional.handle = *handle;
    p.conditional.type = cudaGraphCondTypeWhile;
    p.conditional.size = 1;
#if CUDART_VERSION >= 13000
    error = cudaGraphAddNode(&node, graph, NULL, NULL, 0, &p);
#else
    error = cudaGraphAddNode(&node, graph, NULL, 0, &p);
#endif
    if (error == cudaSuccess)
        *body = p.conditional.phGraph_out[0];
    return error;
}

/* Captures the launches of the turn into the graph. A failure of the capture is
 * not a failure of the device. */
static cudaError_t capture(struct gpu *g, cudaGraph_t graph, loop_turn turn,
                           int *status)
{
    cudaStream_t stream = g->loops->stream, callers = g->stream;
    size_t n = strlen(g->name);
    cudaError_t error = cudaStreamBeginCaptureToGraph(
        stream, graph, NULL, NULL, 0, cudaStreamCaptureModeRelaxed);
    if (error != cudaSuccess)
        return error;
    g->stream = stream;
    *status = turn.run(turn.with);
    g->stream = callers;
    error = cudaStreamEndCapture(stream, &graph);
    if (g->failed) {
        *status = g->failed = DRAPE_OK;
        g->name[n] = 0;
        return cudaErrorUnknown;
    }
    return *status == DRAPE_OK ? error : cudaErrorInvalidValue;
}

static cudaError_t capture_loop(struct gpu *g, cudaGraph_t graph,
                                const int32_t *again, loop_turn turn,
                                int *status)
{
    cudaGraphConditionalHandle handle;
    cudaGraph_t body;
    cudaError_t error = add_while(graph, &body, &handle);
    auto whole = [&] {
        int done = turn.run(turn.with);
        loop_kernel<<<1, 1, 0, g->stream>>>(handle, again);
        return done;
    };
    return error == cudaSuccess ? capture(g, body, whole, status) : error;
}

/* Captures and instantiates the graph of k, and sets k's graph and status. */
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

/* Makes room for one more graph. False if all kept graphs were used recently.
 */
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

/* Captures a new graph and keeps it. NULL if that is not possible. */
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
        cudaGetLastError(); /* forget the error: it means that there are none */
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

static bool open_loops(struct gpu *g)
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

bool gpu_loop(struct gpu *g, struct loop_key key, const int32_t *again,
              loop_turn turn)
{
    if (g->hosted[0] || g->hosted[1] || g->failed || !open_loops(g))
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

void gpu_loops_close(struct gpu *g)
{
    if (!g->loops)
        return;
    for (struct kept *k = g->loops->first; k; k = k->next)
        cudaGraphExecDestroy(k->graph);
    if (g->loops->stream)
        cudaStreamDestroy(g->loops->stream);
}
