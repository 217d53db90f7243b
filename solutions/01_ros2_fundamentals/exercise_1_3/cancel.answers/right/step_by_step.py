"""Right: spin_until_future_complete from one step to the next; British spelling; the status property at the end."""
import rclpy
from action_msgs.msg import GoalStatus
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient


def main(args=None):
    rclpy.init(args=args)
    node = rclpy.create_node('step_by_step')
    log = node.get_logger()
    client = ActionClient(node, Fibonacci, 'fibonacci')
    if not client.wait_for_server(timeout_sec=5.0):
        log.error('server not found')
        rclpy.shutdown()
        return

    count = 0

    def feedback(_):
        nonlocal count
        count += 1

    sending = client.send_goal_async(Fibonacci.Goal(order=20), feedback_callback=feedback)
    rclpy.spin_until_future_complete(node, sending)
    goal = sending.result()
    if not goal.accepted:
        log.error('the server rejected the goal')
        rclpy.shutdown()
        return
    while count < 3:
        rclpy.spin_once(node)
    cancelling = goal.cancel_goal_async()
    rclpy.spin_until_future_complete(node, cancelling)
    log.info(f'server says: {len(cancelling.result().goals_canceling)} goal(s) cancelling')
    waiting = goal.get_result_async()
    rclpy.spin_until_future_complete(node, waiting)
    names = {GoalStatus.STATUS_SUCCEEDED: 'succeeded', GoalStatus.STATUS_CANCELED: 'cancelled', GoalStatus.STATUS_ABORTED: 'aborted'}
    log.info('The goal was ' + names[waiting.result().status])

    client.destroy()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == '__main__':
    main()
