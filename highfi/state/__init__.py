"""What the time loop works on: arrays, poses, passes over the nodes, threads."""
