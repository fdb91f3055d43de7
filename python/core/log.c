/* SPDX-License-Identifier: Apache-2.0 */
/* What a log tells of bodies: core.h. make compiles this file, as it sees the
 * library's own headers: ref/api/record.h has the format. */
#include "python/core/core.h"
#include "ref/api/record.h"

#include <string.h>

enum core_log core_log_piece(const void *piece, size_t bytes, int64_t *body)
{
    struct record_head head;
    if (bytes != sizeof head)
        return CORE_LOG_DATA;
    memcpy(&head, piece, sizeof head);
    if (memcmp(head.magic, RECORD_MAGIC, sizeof head.magic) != 0)
        return CORE_LOG_DATA;
    *body = head.at;
    return head.kind == RECORD_CLOTH || head.kind == RECORD_PANEL
               ? CORE_LOG_CLOTH
           : head.kind == RECORD_MESH   ? CORE_LOG_OBSTACLE
           : head.kind == RECORD_REMOVE ? CORE_LOG_REMOVE
                                        : CORE_LOG_CALL;
}
