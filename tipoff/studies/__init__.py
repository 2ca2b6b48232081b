"""Questions asked of both fidelities: agreement, cost, stability, ablation; the report and the
command line."""
