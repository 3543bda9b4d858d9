// What    Which walk a program is built for (KDRAY_TRAVERSAL), and how many rays a work-item takes.
#ifndef KDRAY_LAYOUT_TRAVERSAL_H
#define KDRAY_LAYOUT_TRAVERSAL_H

#define KDRAY_TRAVERSAL_AUTO 0
#define KDRAY_TRAVERSAL_BINARY 1
#define KDRAY_TRAVERSAL_WIDE 2
#define KDRAY_TRAVERSAL_PACKET 3
#define KDRAY_TRAVERSAL_BATCH 4

// Rays to a work-item of the packet and batch walks: enough that filling and draining the walk costs little.
#define KDRAY_CHUNK 1024u

#ifndef KDRAY_TRAVERSAL
#define KDRAY_TRAVERSAL KDRAY_TRAVERSAL_BINARY
#endif
#endif
