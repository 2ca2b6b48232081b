"""What is known of a launch without a run: its motion along the rail without friction, its end, its
stop. Input is ``launch.Launch``, plain numbers of a scene.
"""
