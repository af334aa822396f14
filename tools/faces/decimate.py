"""Fewer triangles by quadric error metrics (Garland and Heckbert 1997). An edge collapses into one of its ends, so vertices that
stay keep their places. Borders collapse along themselves, and vertices that are to stay do."""
import heapq

import numpy as np


class Decimation:
    """weight: how much an error at a vertex counts. kept: vertices that stay."""

    def __init__(self, vertices, triangles, weight, kept):
        self.at, self.kept = vertices, set(kept)
        self.triangles = {number: tuple(corners) for number, corners in enumerate(triangles)}
        self.around = {}
        for number, corners in self.triangles.items():
            for corner in corners:
                self.around.setdefault(corner, set()).add(number)
        self.quadric = {vertex: np.zeros((4, 4)) for vertex in self.around}
        for corners in self.triangles.values():
            self._add_plane(corners, weight)
        self._add_borders(weight)
        self.heap, self.stamp = [], dict.fromkeys(self.around, 0)
        for vertex in list(self.around):
            for other in self._near(vertex):
                self._offer(vertex, other)

    def _add_plane(self, corners, weight):
        a, b, c = self.at[list(corners)]
        normal = np.cross(b - a, c - a)
        area = np.linalg.norm(normal)
        if area < 1e-12:
            return
        plane = np.append(normal / area, -normal.dot(a) / area)
        for corner in corners:
            self.quadric[corner] += weight[corner] * area * np.outer(plane, plane)

    def _add_borders(self, weight):
        for number, corners in self.triangles.items():
            for a, b in zip(corners, corners[1:] + corners[:1]):
                if len(self.around[a] & self.around[b]) != 1:
                    continue
                p, q, r = self.at[[a, b, next(c for c in corners if c not in (a, b))]]
                across = np.cross(q - p, np.cross(q - p, r - p))
                size = np.linalg.norm(across)
                if size < 1e-12:
                    continue
                plane = np.append(across / size, -across.dot(p) / size)
                for corner in (a, b):
                    self.quadric[corner] += 3 * weight[corner] * (q - p).dot(q - p) * np.outer(plane, plane)

    def _near(self, vertex):
        return {corner for number in self.around[vertex] for corner in self.triangles[number]} - {vertex}

    def _on_border(self, vertex):
        return len(self._near(vertex)) != len(self.around[vertex])

    def _offer(self, gone, stays):
        if gone in self.kept:
            return
        place = np.append(self.at[stays], 1.0)
        cost = place @ (self.quadric[gone] + self.quadric[stays]) @ place
        cost += 1e-7 * ((self.at[gone] - self.at[stays]) ** 2).sum() # of equal ones, the shortest first
        heapq.heappush(self.heap, (cost, gone, stays, self.stamp[gone], self.stamp[stays]))

    def _may(self, gone, stays):
        shared = self.around[gone] & self.around[stays]
        if not shared or len(self._near(gone) & self._near(stays)) != len(shared):
            return False
        if self._on_border(gone) and len(shared) != 1:
            return False # it would leave its border
        for number in self.around[gone] - shared:
            corners = self.triangles[number]
            old, new = self.at[list(corners)], self.at[[stays if c == gone else c for c in corners]]
            before, after = (np.cross(p[1] - p[0], p[2] - p[0]) for p in (old, new))
            longest = max(((new[k] - new[k - 1]) ** 2).sum() for k in range(3))
            if np.linalg.norm(after) < 0.12 * longest:
                return False # a sliver
            if before.dot(after) < 0.3 * np.linalg.norm(before) * np.linalg.norm(after):
                return False
        return True

    def _collapse(self, gone, stays):
        for number in list(self.around[gone]):
            corners = self.triangles[number]
            if stays in corners:
                for corner in corners:
                    self.around[corner].discard(number)
                del self.triangles[number]
            else:
                self.triangles[number] = tuple(stays if c == gone else c for c in corners)
                self.around[stays].add(number)
        del self.around[gone]
        self.quadric[stays] += self.quadric[gone]
        self.stamp[stays] += 1
        for other in self._near(stays):
            self._offer(stays, other)
            self._offer(other, stays)

    def run(self, count, share):
        """Collapses edges until the vertices' shares make up the count, or no edge may. share: of a vertex, 1 or more. Returns the
        triangles."""
        left = sum(share(vertex) for vertex in self.around)
        while self.heap and left > count:
            _, gone, stays, before, after = heapq.heappop(self.heap)
            if gone not in self.around or stays not in self.around:
                continue
            if (self.stamp[gone], self.stamp[stays]) != (before, after):
                continue
            if left - share(gone) >= count and self._may(gone, stays):
                self._collapse(gone, stays)
                left -= share(gone)
        return list(self.triangles.values())
